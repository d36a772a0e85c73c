/// What only happens between processes: deaths, strangers, and starting in any order.
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/wait.h>

#include <chrono>
#include <zmq.hpp>

#include "exchange/carriers.hpp"
#include "exchange/wire.hpp"

namespace interply::exchange {
namespace {

using testing::HasSubstr;

/// A child process that is gone when the test is.
class Child {
 public:
  template <typename Body>
  explicit Child(Body&& body) : pid_(::fork()) {
    if (pid_ != 0) return;
    int code = 0;
    try {
      body();
    } catch (const std::exception&) {
      code = 1;
    }
    ::_exit(code);
  }
  ~Child() { end(SIGKILL); }
  Child(Child&& other) noexcept : pid_(std::exchange(other.pid_, -1)) {}
  void signal(int number) const { ::kill(pid_, number); }
  void end(int number) {
    if (pid_ <= 0) return;
    ::kill(pid_, number);
    ::waitpid(pid_, nullptr, 0);
    pid_ = -1;
  }

 private:
  pid_t pid_;
};

/// A solver that computes for 20 ms per step until it is told to stop.
void run_busy_solver(const std::string& address, int layer) {
  auto link = connect_zeromq(address);
  link->join(make_join("ply_" + std::to_string(layer)), kPatience);
  Force force;
  for (std::int64_t step = 0;; ++step) {
    link->send(make_motion(layer, 300, step));
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    link->receive(force, kPatience);
  }
}

class ProcessTest : public testing::TestWithParam<Carrier> {
 protected:
  /// Answers everyone at once until each has done `steps` steps.
  static void advance(CoordinatorLink& coordinator, int peers, std::int64_t steps) {
    for (int done = 0; done < peers;) {
      const Event event = coordinator.receive(kPatience);
      ASSERT_TRUE(event.kind == Event::Kind::Moved || event.kind == Event::Kind::Joined) << event.message;
      if (event.kind != Event::Kind::Moved) continue;
      const std::int64_t step = coordinator.motion(event.who).step;
      ASSERT_TRUE(is_filled(coordinator.motion(event.who).position, 300, event.who, step));
      if (step <= steps) coordinator.send(event.who, make_force(event.who, 300, step));
      if (step == steps) ++done;
    }
  }
};

INSTANTIATE_TEST_SUITE_P(Carriers, ProcessTest, testing::Values(Carrier::SharedMemory, Carrier::Ipc, Carrier::Tcp),
                         [](const auto& info) { return to_string(info.param); });

TEST_P(ProcessTest, AKilledSolverIsNamedWhileOthersAreBusy) {
  Table table(GetParam(), {{"ply_0", 300}, {"ply_1", 300}, {"ply_2", 300}, {"ply_3", 300}});
  std::vector<Child> children;
  for (int i = 0; i < 4; ++i) children.emplace_back([&, i] { run_busy_solver(table.endpoint(), i); });
  CoordinatorLink& coordinator = table.coordinator();
  advance(coordinator, 4, 5);
  const auto start = std::chrono::steady_clock::now();
  children[2].end(SIGKILL);
  Event event = coordinator.receive(1);
  while (event.kind == Event::Kind::Moved) event = coordinator.receive(1);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  RecordProperty("seconds_until_noticed", std::to_string(seconds));
  std::printf("noticed after %.3f s\n", seconds);
  ASSERT_EQ(event.kind, Event::Kind::Suspect);
  EXPECT_EQ(event.who, 2);
  EXPECT_THAT(event.message, HasSubstr("ply_2"));
  coordinator.stop(StopReason::Lost, "ply_2 died");
}

TEST_P(ProcessTest, TwoDeathsAtOnceAreBothNamed) {
  Table table(GetParam(), {{"ply_0", 300}, {"ply_1", 300}, {"ply_2", 300}});
  std::vector<Child> children;
  for (int i = 0; i < 3; ++i) children.emplace_back([&, i] { run_busy_solver(table.endpoint(), i); });
  CoordinatorLink& coordinator = table.coordinator();
  advance(coordinator, 3, 2);
  children[2].signal(SIGKILL);
  children[0].signal(SIGKILL);
  std::vector<int> suspects;
  while (suspects.size() < 2) {
    const Event event = coordinator.receive(1);
    ASSERT_NE(event.kind, Event::Kind::None);
    if (event.kind == Event::Kind::Suspect) suspects.push_back(event.who);
  }
  EXPECT_THAT(suspects, testing::UnorderedElementsAre(0, 2));
}

TEST_P(ProcessTest, AStoppedSolverIsNotSuspectAndGoesOn) {
  Table table(GetParam(), {{"ply_0", 300}});
  Child child([&] { run_busy_solver(table.endpoint(), 0); });
  advance(table.coordinator(), 1, 3);
  child.signal(SIGSTOP);
  Event event = table.coordinator().receive(0.5);
  if (event.kind == Event::Kind::Moved) {  // sent before it was stopped
    table.coordinator().send(0, make_force(0, 300, 4));
    event = table.coordinator().receive(0.5);
  }
  EXPECT_EQ(event.kind, Event::Kind::None);
  child.signal(SIGCONT);
  EXPECT_EQ(table.coordinator().receive(kPatience).kind, Event::Kind::Moved);
}

/// The deadline reaches the solver in a number of few bits: a long one must not come out short.
TEST_P(ProcessTest, ALongDeadlineIsALongOneForTheOtherEndToo) {
  for (const double deadline : {64.6, 66.0, 131.0}) {
    const auto coordinator =
        bind_zeromq(make_address(GetParam()), kWelcome, {{"ply_0", 300}}, ArraysBy::Mailbox, false, deadline);
    const std::string endpoint = get_endpoint(*coordinator);
    Child child([&] { run_busy_solver(endpoint, 0); });
    advance(*coordinator, 1, 60);  // signs of life have been exchanged, too
    child.signal(SIGSTOP);
    Event event = coordinator->receive(0.5);
    if (event.kind == Event::Kind::Moved) {  // sent before it was stopped
      coordinator->send(0, make_force(0, 300, 61));
      event = coordinator->receive(3);
    }
    EXPECT_EQ(event.kind, Event::Kind::None);
    child.signal(SIGCONT);
    event = coordinator->receive(kPatience);
    EXPECT_EQ(event.kind, Event::Kind::Moved) << deadline << " s: " << event.message;
    coordinator->send(0, make_force(0, 300, coordinator->motion(0).step));
    EXPECT_EQ(coordinator->receive(kPatience).kind, Event::Kind::Moved) << deadline << " s";
  }
}

TEST_P(ProcessTest, AKilledCoordinatorIsNoticed) {
  int pipe[2];
  ASSERT_EQ(::pipe(pipe), 0);
  const std::string address = make_address(GetParam());
  Child child([&] {
    auto coordinator = bind_zeromq(address, kWelcome, {{"ply_0", 300}});
    const std::string endpoint = get_endpoint(*coordinator);
    if (::write(pipe[1], endpoint.data(), endpoint.size()) < 0) return;
    for (;;) coordinator->receive(1);
  });
  char endpoint[200] = {};
  ASSERT_GT(::read(pipe[0], endpoint, sizeof(endpoint) - 1), 0);
  auto link = connect_zeromq(endpoint);
  link->join(make_join("ply_0"), kPatience);
  link->send(make_motion(0, 300, 0));
  child.end(SIGKILL);
  Force force;
  EXPECT_THAT(get_message<CoordinatorLost>([&] { link->receive(force, kPatience); }),
              HasSubstr("closed the connection"));
  link->send_failure("nobody hears this");  // returns
  ::close(pipe[0]);
  ::close(pipe[1]);
  if (GetParam() != Carrier::Tcp) std::filesystem::remove(address.substr(std::string("ipc://").size()));
}

TEST_P(ProcessTest, TheSolverMayStartBeforeTheCoordinator) {
  std::string address = make_address(GetParam());
  if (GetParam() == Carrier::Tcp) address = get_endpoint(*bind_zeromq(address, kWelcome, {}));  // free again
  auto link = connect_zeromq(address);
  std::thread joining([&] { link->join(make_join("ply_0"), kPatience); });
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  auto coordinator = bind_zeromq(address, kWelcome, {{"ply_0", 300}});
  EXPECT_EQ(coordinator->receive(kPatience).kind, Event::Kind::Joined);
  joining.join();
}

TEST_P(ProcessTest, AnAddressWhereNobodyAnswersIsNamedAtTheDeadline) {
  std::string address = make_address(GetParam());
  if (GetParam() == Carrier::Tcp) address = get_endpoint(*bind_zeromq(address, kWelcome, {}));
  auto link = connect_zeromq(address);
  const std::string said = get_message<CoordinatorLost>([&] { link->join(make_join("ply_0"), 0.2); });
  EXPECT_THAT(said, HasSubstr(address));
  EXPECT_THAT(said, HasSubstr("for 0.2 s while joining"));
}

TEST_P(ProcessTest, AnAddressInUseIsRefused) {
  Table table(GetParam(), {{"ply_0", 300}});
  const std::string said = get_message<std::runtime_error>([&] {
    bind_zeromq(table.endpoint(), kWelcome, {{"ply_0", 300}});
  });
  EXPECT_THAT(said, HasSubstr(table.endpoint()));
  EXPECT_NO_THROW(join_as(table, "ply_0")) << "the first one keeps its address";
}

/// Says all kinds of wrong things to the coordinator until told to leave.
void disturb(std::string endpoint, std::atomic<bool>& leave) {
  if (endpoint.starts_with("shm://")) endpoint.replace(0, 3, "ipc");
  zmq::context_t context;
  Encoder encoder;
  while (!leave) {
    zmq::socket_t dealer(context, zmq::socket_type::dealer);
    dealer.set(zmq::sockopt::linger, 100);
    dealer.connect(endpoint);
    const auto say = [&](Bytes frame) {
      dealer.send(zmq::const_buffer(frame.data(), frame.size()), zmq::send_flags::none);
    };
    say(encoder.encode(make_motion(0, 300, 5)));
    say(encoder.encode(make_force(0, 300, 5)));
    say(encoder.encode(Stop{StopReason::Cancelled, "not yours to say"}));
    say(encoder.encode(Final{}));
    say(encoder.encode(make_join("ply_0")));
    say({});
    dealer.send(zmq::str_buffer("garbage"), zmq::send_flags::none);
    dealer.send(zmq::str_buffer("in"), zmq::send_flags::sndmore);
    dealer.send(zmq::str_buffer("three"), zmq::send_flags::sndmore);
    dealer.send(zmq::str_buffer("parts"), zmq::send_flags::none);
    zmq::socket_t request(context, zmq::socket_type::req);
    request.set(zmq::sockopt::linger, 100);
    request.connect(endpoint);
    request.send(zmq::str_buffer("hello?"), zmq::send_flags::none);
    zmq::socket_t large(context, zmq::socket_type::dealer);
    large.set(zmq::sockopt::linger, 100);
    large.connect(endpoint);
    const std::vector<char> bulk(8 << 20);
    large.send(zmq::buffer(bulk), zmq::send_flags::none);
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }
}

/// Connects without speaking ZeroMQ.
void disturb_raw(int port) {
  const int s = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in to{};
  to.sin_family = AF_INET;
  to.sin_port = htons(static_cast<std::uint16_t>(port));
  to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  const char request[] = "GET / HTTP/1.0\r\n\r\n";
  if (::connect(s, reinterpret_cast<const sockaddr*>(&to), sizeof(to)) == 0 &&
      ::send(s, request, sizeof(request), MSG_NOSIGNAL) < 0)
    ADD_FAILURE() << "nothing was sent";
  ::close(s);
}

TEST_P(ProcessTest, StrangersDoNotDisturbARun) {
  const LogCapture log;
  {
    Table table(GetParam(), {{"ply_0", 300}, {"ply_1", 300}, {"ply_2", 300}});
    std::atomic<bool> leave{false};
    std::vector<std::thread> solvers;
    std::array<std::int64_t, 3> good{};
    for (int i = 0; i < 3; ++i)
      solvers.emplace_back([&, i] {
        auto link = table.connect();
        link->join(make_join("ply_" + std::to_string(i)), kPatience);
        Force force;
        do {
          link->send(make_motion(i, 300, good[static_cast<std::size_t>(i)]));
          link->receive(force, kPatience);
          if (!is_filled(force.force, 300, i + 100, good[static_cast<std::size_t>(i)])) return;
          ++good[static_cast<std::size_t>(i)];
        } while (!force.last);
        link->send(Final{});
      });
    CoordinatorLink& coordinator = table.coordinator();
    std::thread stranger;
    int joined = 0, ended = 0;
    while (ended < 3) {
      const Event event = coordinator.receive(kPatience);
      if (event.kind == Event::Kind::Moved) {
        const std::int64_t step = coordinator.motion(event.who).step;
        EXPECT_TRUE(is_filled(coordinator.motion(event.who).position, 300, event.who, step));
        coordinator.send(event.who, make_force(event.who, 300, step, step == 2000));
        if (GetParam() == Carrier::Tcp && step % 200 == 0)
          disturb_raw(std::stoi(table.endpoint().substr(table.endpoint().rfind(':') + 1)));
      } else if (event.kind == Event::Kind::Joined) {
        if (++joined == 3) stranger = std::thread([&] { disturb(table.endpoint(), leave); });
      } else if (event.kind == Event::Kind::Ended) {
        ++ended;
      } else {
        ADD_FAILURE() << "unexpected event " << static_cast<int>(event.kind) << ": " << event.message;
        coordinator.stop(StopReason::Lost, "test failed");
        break;
      }
    }
    leave = true;
    for (auto& s : solvers) s.join();
    if (stranger.joinable()) stranger.join();
    for (const auto g : good) EXPECT_EQ(g, 2001);
  }
  EXPECT_THAT(log.text(), HasSubstr("without having joined"));
  EXPECT_THAT(log.text(), HasSubstr("malformed"));
  EXPECT_THAT(log.text(), HasSubstr("several parts"));
  EXPECT_THAT(log.text(), HasSubstr("has joined before"));
  EXPECT_LE(log.count("\n"), 8) << log.text();
}

TEST(Zeromq, AddressesThatCannotBeAreRefused) {
  EXPECT_THAT(get_message<std::runtime_error>([] { bind_zeromq("nonsense", kWelcome, {}); }), HasSubstr("nonsense"));
  EXPECT_THAT(get_message<std::runtime_error>([] { connect_zeromq("tcp://no-port"); }), HasSubstr("tcp://no-port"));
  EXPECT_THAT(get_message<std::runtime_error>([] { bind_zeromq("ipc:///no/such/folder/x", kWelcome, {}); }),
              HasSubstr("/no/such/folder"));
}

}  // namespace
}  // namespace interply::exchange
