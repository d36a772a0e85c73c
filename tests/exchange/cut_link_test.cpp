/// A link that carries nothing any more and says nothing of it: a pulled cable, a host that is gone, a stopped process.
#include <netinet/in.h>
#include <poll.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>

#include <array>
#include <chrono>

#include "exchange/carriers.hpp"
#include "exchange/descriptor.hpp"

namespace interply::exchange {
namespace {

using testing::HasSubstr;

constexpr double kSilence = 1;  ///< s that both ends of these tests allow

/// A cable between a solver and a coordinator on loopback that can be cut: both ends stay connected, nothing passes.
class Cable {
 public:
  explicit Cable(int to) : listener_(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_in name = loopback(0);
    socklen_t length = sizeof(name);
    EXPECT_EQ(::bind(listener_.number(), reinterpret_cast<sockaddr*>(&name), length), 0);
    EXPECT_EQ(::listen(listener_.number(), 1), 0);
    ::getsockname(listener_.number(), reinterpret_cast<sockaddr*>(&name), &length);
    port_ = ntohs(name.sin_port);
    thread_ = std::jthread([this, to](const std::stop_token& stop) { carry(to, stop); });
  }
  int port() const { return port_; }
  void cut() { cut_ = true; }

 private:
  static sockaddr_in loopback(int port) {
    sockaddr_in name{};
    name.sin_family = AF_INET;
    name.sin_port = htons(static_cast<std::uint16_t>(port));
    name.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    return name;
  }
  void carry(int to, const std::stop_token& stop) {
    pollfd waiting{listener_.number(), POLLIN, 0};
    while (::poll(&waiting, 1, 20) == 0)
      if (stop.stop_requested()) return;
    const std::array ends{Descriptor(::accept(listener_.number(), nullptr, nullptr)),
                          Descriptor(::socket(AF_INET, SOCK_STREAM, 0))};
    const sockaddr_in name = loopback(to);
    if (::connect(ends[1].number(), reinterpret_cast<const sockaddr*>(&name), sizeof(name)) != 0) return;
    std::array<char, 4096> bytes;
    while (!stop.stop_requested()) {
      std::array<pollfd, 2> ready{{{ends[0].number(), POLLIN, 0}, {ends[1].number(), POLLIN, 0}}};
      ::poll(ready.data(), ready.size(), 20);
      for (std::size_t i = 0; i < 2 && !cut_; ++i) {
        if (ready[i].revents == 0) continue;
        const ssize_t n = ::recv(ends[i].number(), bytes.data(), bytes.size(), 0);
        if (n <= 0) return;
        for (ssize_t sent = 0; sent < n;)
          sent += std::max<ssize_t>(::send(ends[1 - i].number(), bytes.data() + sent, n - sent, MSG_NOSIGNAL), 0);
      }
      if (cut_) std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  }
  Descriptor listener_;
  int port_ = 0;
  std::atomic<bool> cut_ = false;
  std::jthread thread_;
};

TEST(CutLink, IsNoticedAtBothEndsAtTheDeadlineAndNotBefore) {
  auto coordinator = bind_zeromq("tcp://127.0.0.1:0", kWelcome, {{"ply_0", 30}}, ArraysBy::Messages, false, kSilence);
  const std::string bound = get_endpoint(*coordinator);
  Cable cable(std::stoi(bound.substr(bound.rfind(':') + 1)));
  const auto solver = connect_zeromq("tcp://127.0.0.1:" + std::to_string(cable.port()), kSilence);
  std::chrono::duration<double> noticed{};
  std::string said;
  std::jthread computing([&] {
    solver->join(make_join("ply_0"), kPatience);
    Force force;
    solver->send(make_motion(0, 30, 0));
    solver->receive(force, kPatience);
    solver->send(make_motion(0, 30, 1));  // is taken by the kernel, at least
    const auto start = std::chrono::steady_clock::now();
    said = get_message<CoordinatorLost>([&] { solver->receive(force, kPatience); });
    noticed = std::chrono::steady_clock::now() - start;
  });
  while (coordinator->receive(kPatience).kind != Event::Kind::Moved) {
  }
  std::this_thread::sleep_for(std::chrono::duration<double>(3 * kSilence));
  EXPECT_EQ(coordinator->receive(0).kind, Event::Kind::None) << "who only computes for long is heard";
  coordinator->send(0, make_force(0, 30, 0));
  EXPECT_EQ(coordinator->receive(kPatience).kind, Event::Kind::Moved);
  const auto start = std::chrono::steady_clock::now();
  cable.cut();
  const Event event = coordinator->receive(kPatience);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  EXPECT_EQ(event.kind, Event::Kind::Suspect);
  EXPECT_EQ(event.who, 0);
  EXPECT_GE(seconds, 0.9 * kSilence);
  EXPECT_LT(seconds, kSilence + 3);
  computing.join();
  EXPECT_THAT(said, HasSubstr("closed the connection"));
  EXPECT_GE(noticed.count(), 0.9 * kSilence);
  EXPECT_LT(noticed.count(), kSilence + 4);
}

TEST(CutLink, AStoppedCoordinatorIsLostAtTheDeadline) {
  int pipe[2];
  ASSERT_EQ(::pipe(pipe), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    const auto coordinator =
        bind_zeromq("tcp://127.0.0.1:0", kWelcome, {{"ply_0", 30}}, ArraysBy::Messages, false, kSilence);
    const std::string endpoint = get_endpoint(*coordinator);
    if (::write(pipe[1], endpoint.data(), endpoint.size()) < 0) ::_exit(1);
    for (;;) coordinator->receive(1);
  }
  char endpoint[200] = {};
  ASSERT_GT(::read(pipe[0], endpoint, sizeof(endpoint) - 1), 0);
  const auto solver = connect_zeromq(endpoint, kSilence);
  solver->join(make_join("ply_0"), kPatience);
  solver->send(make_motion(0, 30, 0));
  ::kill(child, SIGSTOP);
  Force force;
  EXPECT_THAT(get_message<CoordinatorLost>([&] { solver->receive(force, kPatience); }),
              HasSubstr("closed the connection"));
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  ::close(pipe[0]);
  ::close(pipe[1]);
}

}  // namespace
}  // namespace interply::exchange
