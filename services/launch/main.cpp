#include <csignal>

#include "launch/command_line.hpp"

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a write beyond a limit on the size of files says so
  return interply::launch::run_command_line(argc, argv);
}
