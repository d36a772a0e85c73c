#include "launch/command_line.hpp"

int main(int argc, char** argv) { return interply::launch::run_command_line(argc, argv); }
