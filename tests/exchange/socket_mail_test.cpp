/// Sockets of their own for arrays: who may use them, what happens to those who cannot, and that a connection that ends
/// or says what cannot be is named.
#include "exchange/socket_mail.hpp"

#include <chrono>
#include <optional>

#include "exchange/carriers.hpp"
#include "exchange/raw_tcp.hpp"

namespace interply::exchange {
namespace {

using testing::HasSubstr;

Expected expect(int layer, std::int64_t n) { return {"ply_" + std::to_string(layer), n}; }

/// Listens at a port that has a free one after it.
RawTcp listen_below_a_free_port() {
  for (;;) {
    RawTcp socket = RawTcp::listen("127.0.0.1", 0);
    try {
      RawTcp::listen("127.0.0.1", socket.port() + 1);
      return socket;
    } catch (const std::runtime_error&) {
    }
  }
}

class SocketMailAt : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Addresses, SocketMailAt, testing::Values("127.0.0.1", "0.0.0.0"),
                         [](const auto& info) { return info.param == "0.0.0.0" ? "EveryInterface" : "OneInterface"; });

TEST_P(SocketMailAt, MotionAndForceCrossAndTurnsAreKept) {
  const RawTcp messages = listen_below_a_free_port();
  SocketMailRoom room("tcp://" + GetParam() + ":" + std::to_string(messages.port()), {expect(0, 3), expect(1, 7)});
  const auto offer = std::get<SocketOffer>(room.offer(1));
  EXPECT_EQ(offer.port, messages.port() + 1) << "a firewall may have to know it";
  const RawTcp connection = RawTcp::connect("127.0.0.1", messages.port());
  SocketMailbox box(connection.descriptor(), offer);
  EXPECT_FALSE(box.post(make_motion(1, 7, 0))) << "the coordinator has not answered yet";
  const auto until = [&](auto&& done) {
    for (int i = 0; i < 2000 && !done(); ++i) {
      room.look();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  };
  bool posted = false;
  until([&] { return posted = box.post(make_motion(1, 7, 0)); });
  ASSERT_TRUE(posted);
  EXPECT_FALSE(box.post(make_motion(1, 7, 1))) << "not its turn";
  until([&] { return room.has_mail(1); });
  ASSERT_TRUE(room.has_mail(1));
  EXPECT_FALSE(room.has_mail(0));
  const MotionMail mail = room.take(1);
  EXPECT_FALSE(room.has_mail(1));
  Motion motion;
  room.read(1, mail, motion);
  EXPECT_EQ(motion.step, 0);
  EXPECT_EQ(motion.vote, 1e-7);
  EXPECT_TRUE(is_filled(motion.position, 7, 1, 0));
  EXPECT_EQ(motion.thickness.size(), 0);
  EXPECT_FALSE(box.has_mail());
  ASSERT_TRUE(room.answer(1, make_force(1, 7, 0, true)));
  until([&] { return box.has_mail(); });
  ASSERT_TRUE(box.has_mail());
  EXPECT_FALSE(box.post(make_motion(1, 7, 1))) << "the answer is not read yet";
  Force force;
  EXPECT_EQ(box.read(force), 0);
  EXPECT_TRUE(force.last);
  EXPECT_TRUE(is_filled(force.force, 7, 101, 0));
  EXPECT_FALSE(box.post(make_motion(1, 6, 1))) << "of another size";
}

/// A coordinator, and a solver by hand: messages and sockets are written byte by byte.
class SocketMailByHand : public testing::Test {
 protected:
  static constexpr std::int64_t kNodes = 5;

  /// Joins as ply_0 and opens the second connection.
  void join() {
    solver_.emplace(table_.endpoint());
    solver_->send(encoder_.encode(make_join("ply_0")));
    ASSERT_EQ(table_.coordinator().receive(kPatience).kind, Event::Kind::Joined);
    MailOffer offer;
    ASSERT_EQ(solver_->receive(decoder_), MessageKind::Welcome);
    decoder_.read(offer);
    offer_ = std::get<SocketOffer>(offer);
    arrays_.emplace(RawTcp::connect("127.0.0.1", offer_.port));
  }
  void say_hello() {
    arrays_->send(Hello{.token = offer_.token});
    EXPECT_EQ(table_.coordinator().receive(0.1).kind, Event::Kind::None);
    EXPECT_EQ(arrays_->receive<std::uint64_t>(), kMailMagic);
  }
  static MotionHeader make_header(std::int64_t step) {
    return {.n_nodes = kNodes, .mail = make_mail(make_motion(0, kNodes, step))};
  }
  /// The sentence about the one that is lost.
  std::string get_loss() {
    const auto start = std::chrono::steady_clock::now();
    const Event event = table_.coordinator().receive(kPatience);
    EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5)) << "noticed, not timed out";
    EXPECT_EQ(event.kind, Event::Kind::Suspect);
    EXPECT_EQ(event.who, 0);
    EXPECT_FALSE(table_.coordinator().send(0, make_force(0, kNodes, 0)));
    EXPECT_EQ(table_.coordinator().receive(0.05).kind, Event::Kind::None) << "said once";
    return event.message;
  }

  Table table_{Carrier::Tcp, {expect(0, kNodes), expect(1, kNodes)}};
  Encoder encoder_;
  Decoder decoder_;
  std::optional<RawDealer> solver_;
  std::optional<RawTcp> arrays_;
  SocketOffer offer_;
};

TEST_F(SocketMailByHand, BytesAreThoseOfTheDescription) {
  join();
  say_hello();
  const Motion motion = make_motion(0, kNodes, 0);
  MotionHeader header = make_header(0);
  header.mail.n_thickness = kNodes;
  const std::array<double, kNodes> thickness{1, 2, 3, 4, 5};
  arrays_->send(header);
  EXPECT_EQ(table_.coordinator().receive(0.05).kind, Event::Kind::None) << "not whole yet";
  arrays_->send_bytes(motion.position.data(), sizeof(double) * 3 * kNodes);
  arrays_->send(thickness);
  ASSERT_EQ(table_.coordinator().receive(kPatience).kind, Event::Kind::Moved);
  EXPECT_TRUE(same_bits(table_.coordinator().motion(0).position, motion.position));
  EXPECT_EQ(table_.coordinator().motion(0).thickness(4), 5);
  const Force force = make_force(0, kNodes, 0);
  ASSERT_TRUE(table_.coordinator().send(0, force));
  const auto answer = arrays_->receive<ForceHeader>();
  EXPECT_EQ(answer.n_nodes, kNodes);
  EXPECT_EQ(answer.mail.step, 0);
  EXPECT_EQ(answer.mail.next_dt, 1e-7);
  EXPECT_EQ((arrays_->receive<std::array<double, 3 * kNodes>>())[7], force.force(1, 2));
}

TEST_F(SocketMailByHand, AConnectionCutWithinAMotionIsNamed) {
  join();
  say_hello();
  arrays_->send(make_header(0));
  EXPECT_EQ(table_.coordinator().receive(0.05).kind, Event::Kind::None);
  arrays_.reset();
  const std::string said = get_loss();
  EXPECT_THAT(said, HasSubstr("ply_0"));
  EXPECT_THAT(said, HasSubstr("the socket for its arrays has ended"));
}

TEST_F(SocketMailByHand, AWholeMotionComesBeforeTheEndOfItsConnection) {
  join();
  say_hello();
  arrays_->send(make_header(0));
  arrays_->send_bytes(make_motion(0, kNodes, 0).position.data(), sizeof(double) * 3 * kNodes);
  arrays_.reset();
  EXPECT_EQ(table_.coordinator().receive(kPatience).kind, Event::Kind::Moved);
  EXPECT_THAT(get_loss(), HasSubstr("the socket for its arrays has ended"));
}

TEST_F(SocketMailByHand, AMotionOfAnotherSizeIsNamed) {
  join();
  say_hello();
  MotionHeader header = make_header(0);
  header.n_nodes = 7;
  arrays_->send(header);
  EXPECT_THAT(get_loss(), HasSubstr("of 7 nodes and 0 thicknesses, the scene gives it 5 nodes"));
}

TEST_F(SocketMailByHand, AMotionWithSomeThicknessesIsNamed) {
  join();
  say_hello();
  MotionHeader header = make_header(0);
  header.mail.n_thickness = -1;
  arrays_->send(header);
  EXPECT_THAT(get_loss(), HasSubstr("5 nodes and -1 thicknesses"));
}

TEST_F(SocketMailByHand, AMotionOutOfTurnIsNamed) {
  join();
  say_hello();
  const Motion motion = make_motion(0, kNodes, 0);
  arrays_->send(make_header(0));
  arrays_->send_bytes(motion.position.data(), sizeof(double) * 3 * kNodes);
  ASSERT_EQ(table_.coordinator().receive(kPatience).kind, Event::Kind::Moved);
  arrays_->send(make_header(1));
  EXPECT_THAT(get_loss(), HasSubstr("before the last one was answered"));
}

TEST_F(SocketMailByHand, AnotherStepIsRefusedAndTheRunGoesOnWithMessages) {
  const LogCapture log;
  join();
  say_hello();
  arrays_->send(make_header(-3));
  arrays_->send_bytes(make_motion(0, kNodes, 0).position.data(), sizeof(double) * 3 * kNodes);
  EXPECT_EQ(table_.coordinator().receive(0.1).kind, Event::Kind::None);
  EXPECT_EQ(log.count("sent a motion of step -3, expected was step 0"), 1) << log.text();
  solver_->send(encoder_.encode(make_motion(0, kNodes, 0)));
  EXPECT_EQ(table_.coordinator().receive(kPatience).kind, Event::Kind::Moved);
  ASSERT_TRUE(table_.coordinator().send(0, make_force(0, kNodes, 0)));
  EXPECT_EQ(solver_->receive(decoder_), MessageKind::Force) << "the way the motion came";
}

TEST_F(SocketMailByHand, AStrangerNeedsATokenAndHoldsNobodyUp) {
  const LogCapture log;
  join();
  const auto hang_up = [&](const Hello& hello) {
    RawTcp stranger = RawTcp::connect("127.0.0.1", offer_.port);
    stranger.send(hello);
    EXPECT_EQ(table_.coordinator().receive(0.05).kind, Event::Kind::None);
    EXPECT_TRUE(stranger.has_ended());
  };
  hang_up({.token = offer_.token + 1});
  hang_up({.magic = __builtin_bswap64(kMailMagic), .token = offer_.token});  // a machine of another byte order
  EXPECT_EQ(log.count("did not say the token of a layer"), 1) << log.text();
  std::vector<RawTcp> silent;
  for (int i = 0; i < 10; ++i) {
    silent.push_back(RawTcp::connect("127.0.0.1", offer_.port));
    silent.back().send('x');
  }
  EXPECT_EQ(table_.coordinator().receive(0.05).kind, Event::Kind::None);
  say_hello();
  hang_up({.token = offer_.token});  // a seat is taken once
  for (int i = 0; i < 100; ++i) {
    silent.push_back(RawTcp::connect("127.0.0.1", offer_.port));
    if (i % 20 == 0) {
      EXPECT_EQ(table_.coordinator().receive(0.01).kind, Event::Kind::None);
    }
  }
  arrays_->send(make_header(0));
  arrays_->send_bytes(make_motion(0, kNodes, 0).position.data(), sizeof(double) * 3 * kNodes);
  EXPECT_EQ(table_.coordinator().receive(kPatience).kind, Event::Kind::Moved);
}

TEST(SocketMail, ASolverBehindAForwardedPortFallsBackToMessagesAndSaysSo) {
  const LogCapture log;
  Table table(Carrier::Tcp, {expect(0, 9)});
  const int port = std::stoi(table.endpoint().substr(table.endpoint().rfind(':') + 1));
  {
    const Forwarder forwarder("127.0.0.2", port, "127.0.0.1");  // and not the port after it
    auto link = connect_zeromq("tcp://127.0.0.2:" + std::to_string(port));
    std::thread solver([&] {
      link->join(make_join("ply_0"), kPatience);
      EXPECT_TRUE(advance(*link, 0, 9, 20));
    });
    EXPECT_TRUE(answer_all(table.coordinator(), 1, 9, 20));
    solver.join();
  }
  EXPECT_EQ(log.count("port for arrays cannot be used (Connection refused): positions and forces travel as messages"),
            1)
      << log.text();
}

TEST(SocketMail, APortWhereNobodyAnswersHoldsNobodyUp) {
  Table table(Carrier::Tcp, {expect(0, 9)});
  const int port = std::stoi(table.endpoint().substr(table.endpoint().rfind(':') + 1));
  const Forwarder forwarder("127.0.0.2", port, "127.0.0.1");
  const RawTcp silent = RawTcp::listen("127.0.0.2", port + 1);
  auto link = connect_zeromq("tcp://127.0.0.2:" + std::to_string(port));
  const auto start = std::chrono::steady_clock::now();
  std::thread solver([&] {
    link->join(make_join("ply_0"), kPatience);
    EXPECT_TRUE(advance(*link, 0, 9, 20));
  });
  EXPECT_TRUE(answer_all(table.coordinator(), 1, 9, 20));
  solver.join();
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
}

/// A coordinator by hand answers step 0 with a message and step 1 with `reply` bytes of a force, then hangs up.
/// @returns what the solver says
std::string get_end(std::size_t reply, std::int64_t n_nodes) {
  const RawTcp arrays = RawTcp::listen("127.0.0.1", 0);
  RawRouter router;
  std::string said;
  std::thread solver([&] {
    auto link = connect_zeromq(router.endpoint());
    link->join(make_join("ply_0"), kPatience);
    Force force;
    link->send(make_motion(0, 5, 0));
    link->receive(force, kPatience);
    link->send(make_motion(0, 5, 1));
    said = get_message<CoordinatorLost>([&] { link->receive(force, kPatience); });
  });
  Encoder encoder;
  Decoder decoder;
  EXPECT_EQ(router.receive(decoder), MessageKind::Join);
  router.send(encoder.encode(kWelcome, SocketOffer{.port = arrays.port(), .token = 77, .n_nodes = 5}));
  RawTcp connection = arrays.accept();
  EXPECT_EQ(router.receive(decoder), MessageKind::Motion) << "nobody waits for the second connection";
  EXPECT_EQ(connection.receive<Hello>().token, 77u);
  connection.send(kMailMagic);
  router.send(encoder.encode(make_force(0, 5, 0)));
  EXPECT_EQ(connection.receive<MotionHeader>().mail.step, 1);
  connection.receive<std::array<double, 15>>();
  const ForceHeader header{.n_nodes = n_nodes, .mail = make_mail(make_force(0, 5, 1))};
  connection.send_bytes(&header, reply);
  connection.end();
  solver.join();
  return said;
}

TEST(SocketMail, ACoordinatorThatHangsUpWithinAForceIsNamed) {
  EXPECT_THAT(get_end(sizeof(ForceHeader), 5), HasSubstr("closed the connection for arrays at step 1"));
  EXPECT_THAT(get_end(3, 5), HasSubstr("closed the connection for arrays at step 1"));
}

TEST(SocketMail, AForceOfAnotherSizeEndsTheConnection) {
  EXPECT_THAT(get_end(sizeof(ForceHeader), 6), HasSubstr("connection for arrays at step 1"));
}

}  // namespace
}  // namespace interply::exchange
