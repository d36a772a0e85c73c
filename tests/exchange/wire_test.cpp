#include "exchange/wire.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <limits>
#include <random>

#include "exchange/carriers.hpp"

namespace interply::exchange {
namespace {

using testing::HasSubstr;

std::vector<std::byte> copy(Bytes frame) { return {frame.begin(), frame.end()}; }

/// Values that text or arithmetic would not keep.
mechanics::NodalVectors make_awkward() {
  mechanics::NodalVectors a(3, 2);
  a << std::bit_cast<double>(0x7ff8dead0000beefull), -0.0, std::numeric_limits<double>::denorm_min(),
      std::numeric_limits<double>::infinity(), std::bit_cast<double>(0xfff0000000000001ull), 0x1.fffffffffffffp1023;
  return a;
}

Motion make_awkward_motion() {
  Motion motion;
  motion.step = 1234567890123;
  motion.vote = std::bit_cast<double>(0x7ff8000000000007ull);
  motion.energies = {.kinetic = -0.0, .internal = 2, .internal_work = 3, .contact_work = -4e-310};
  motion.step_seconds = 0.25;
  motion.wait_seconds = 0.125;
  motion.position = make_awkward();
  motion.thickness = mechanics::Scalars::LinSpaced(2, 0.3, 0.4);
  return motion;
}

TEST(Wire, MotionKeepsEveryBit) {
  Encoder encoder;
  Decoder decoder;
  const Motion sent = make_awkward_motion();
  const auto frame = copy(encoder.encode(sent));
  ASSERT_EQ(decoder.open(frame), MessageKind::Motion);
  EXPECT_EQ(decoder.n_nodes(), 2);
  EXPECT_EQ(decoder.n_thickness(), 2);
  Motion got;
  decoder.read(got);
  EXPECT_EQ(got.step, sent.step);
  EXPECT_EQ(std::bit_cast<std::uint64_t>(got.vote), std::bit_cast<std::uint64_t>(sent.vote));
  EXPECT_EQ(std::memcmp(&got.energies, &sent.energies, sizeof(LayerEnergies)), 0);
  EXPECT_EQ(got.step_seconds, 0.25);
  EXPECT_EQ(got.wait_seconds, 0.125);
  EXPECT_TRUE(same_bits(got.position, sent.position));
  EXPECT_TRUE(same_bits(got.thickness, sent.thickness));
}

TEST(Wire, ForceKeepsEveryBit) {
  Encoder encoder;
  Decoder decoder;
  Force sent{.step = 7,
             .time = 0x1.123456789abcdp-20,
             .next_dt = 4.9e-324,
             .frame = -1,
             .last = true,
             .force = make_awkward()};
  const auto frame = copy(encoder.encode(sent));
  ASSERT_EQ(decoder.open(frame), MessageKind::Force);
  Force got;
  decoder.read(got);
  EXPECT_EQ(got.step, 7);
  EXPECT_EQ(got.time, sent.time);
  EXPECT_EQ(got.next_dt, sent.next_dt);
  EXPECT_EQ(got.frame, -1);
  EXPECT_TRUE(got.last);
  EXPECT_TRUE(same_bits(got.force, sent.force));
}

TEST(Wire, AbsentThicknessAndNoNodesAreMessagesToo) {
  Encoder encoder;
  Decoder decoder;
  Motion sent;
  sent.position.resize(3, 0);
  ASSERT_EQ(decoder.open(encoder.encode(sent)), MessageKind::Motion);
  Motion got = make_awkward_motion();
  decoder.read(got);
  EXPECT_EQ(got.position.cols(), 0);
  EXPECT_EQ(got.thickness.size(), 0);
}

TEST(Wire, SentencesNamesAndNumbersArrive) {
  Encoder encoder;
  Decoder decoder;
  const std::string odd = std::string("broken \xff utf-8, \n and a zero ") + '\0' + "end";
  Join join = make_join("ply_2"), join_got;
  join.host = odd;
  ASSERT_EQ(decoder.open(encoder.encode(join)), MessageKind::Join);
  decoder.read(join_got);
  EXPECT_EQ(join_got.version, join.version);
  EXPECT_EQ(join_got.scene_digest, join.scene_digest);
  EXPECT_EQ(join_got.layer, "ply_2");
  EXPECT_EQ(join_got.pid, join.pid);
  EXPECT_EQ(join_got.host, odd);

  Final final{.digest = 0xfedcba9876543210,
              .energies = {.kinetic = 1},
              .summary = {{"thinning", "-", 0.25}, {"gamma", "rad", 1}},
              .outside_trust = {{.quantity = "thinning",
                                 .unit = "%",
                                 .meaning = "necks",
                                 .limit = 25,
                                 .worst = 54,
                                 .share = 0.03,
                                 .x = 10,
                                 .y = -5,
                                 .first_time = 9e-3}}};
  Final final_got;
  ASSERT_EQ(decoder.open(encoder.encode(final)), MessageKind::Final);
  decoder.read(final_got);
  EXPECT_EQ(final_got.digest, final.digest);
  EXPECT_EQ(final_got.energies.kinetic, 1);
  ASSERT_EQ(final_got.summary.size(), 2u);
  EXPECT_EQ(final_got.summary[1].name, "gamma");
  EXPECT_EQ(final_got.summary[1].unit, "rad");
  EXPECT_EQ(final_got.summary[0].value, 0.25);
  ASSERT_EQ(final_got.outside_trust.size(), 1u);
  const OutsideTrust& passed = final_got.outside_trust[0];
  EXPECT_EQ(passed.quantity, "thinning");
  EXPECT_EQ(passed.unit, "%");
  EXPECT_EQ(passed.meaning, "necks");
  const std::vector<double> numbers{passed.limit, passed.worst, passed.share, passed.x, passed.y, passed.first_time};
  EXPECT_EQ(numbers, (std::vector<double>{25, 54, 0.03, 10, -5, 9e-3}));

  for (const StopReason reason : {StopReason::Diverged, StopReason::Lost, StopReason::Cancelled}) {
    Stop stop;
    ASSERT_EQ(decoder.open(encoder.encode(Stop{reason, odd})), MessageKind::Stop);
    decoder.read(stop);
    EXPECT_EQ(stop.reason, reason);
    EXPECT_EQ(stop.message, odd);
  }
  Refusal refusal;
  ASSERT_EQ(decoder.open(encoder.encode(Refusal{odd})), MessageKind::Refusal);
  decoder.read(refusal);
  EXPECT_EQ(refusal.sentence, odd);
  Failure failure;
  ASSERT_EQ(decoder.open(encoder.encode(Failure{odd})), MessageKind::Failure);
  decoder.read(failure);
  EXPECT_EQ(failure.message, odd);
  Welcome welcome;
  EXPECT_EQ(decoder.open(encoder.encode(kWelcome)), MessageKind::Welcome);
  decoder.read(welcome);
  EXPECT_EQ(welcome.scene_text, kWelcome.scene_text);
  EXPECT_EQ(welcome.scene_digest, kDigest);
  EXPECT_EQ(welcome.run, kWelcome.run);
  MailOffer read;
  decoder.read(read);
  EXPECT_TRUE(std::holds_alternative<std::monostate>(read)) << "no mailbox unless one is offered";
  const MemoryOffer offered{
      .pid = 1, .memory = 2, .coordinator_bell = 3, .solver_bell = 4, .token = 5, .offset = 6, .n_nodes = 7};
  EXPECT_EQ(decoder.open(encoder.encode(kWelcome, offered)), MessageKind::Welcome);
  decoder.read(read);
  const auto& offer = std::get<MemoryOffer>(read);
  EXPECT_EQ(offer.pid, 1);
  EXPECT_EQ(offer.memory, 2);
  EXPECT_EQ(offer.coordinator_bell, 3);
  EXPECT_EQ(offer.solver_bell, 4);
  EXPECT_EQ(offer.token, 5u);
  EXPECT_EQ(offer.offset, 6);
  EXPECT_EQ(offer.n_nodes, 7);
  decoder.open(encoder.encode(kWelcome, SocketOffer{.port = 8, .token = 9, .n_nodes = 10}));
  decoder.read(read);
  EXPECT_EQ(std::get<SocketOffer>(read).port, 8);
  EXPECT_EQ(std::get<SocketOffer>(read).token, 9u);
  EXPECT_EQ(std::get<SocketOffer>(read).n_nodes, 10);
  EXPECT_EQ(decoder.open(encoder.encode(Received{})), MessageKind::Received);
}

TEST(Wire, ArraysStartAtAMultipleOfEight) {
  Encoder encoder;
  for (std::int64_t step : {0ll, 1ll, 300ll, 1ll << 40}) {
    Motion motion = make_awkward_motion();
    motion.step = step;
    EXPECT_EQ(encoder.encode(motion).size() % 8, 0u);
  }
}

TEST(Wire, EveryTruncationIsMalformed) {
  Encoder encoder;
  Decoder decoder;
  const auto frame = copy(encoder.encode(make_awkward_motion()));
  for (std::size_t n = 0; n < frame.size(); ++n)
    EXPECT_THROW(decoder.open(Bytes(frame.data(), n)), Malformed) << n << " of " << frame.size();
  auto longer = frame;
  longer.resize(frame.size() + 8);
  EXPECT_THROW(decoder.open(longer), Malformed);
}

/// @returns whether the bytes were a message; reads all of it if so
bool try_to_read(Decoder& decoder, Bytes frame) {
  try {
    switch (decoder.open(frame)) {
      case MessageKind::Join: {
        Join m;
        decoder.read(m);
        break;
      }
      case MessageKind::Motion: {
        Motion m;
        decoder.read(m);
        break;
      }
      case MessageKind::Force: {
        Force m;
        decoder.read(m);
        break;
      }
      case MessageKind::Final: {
        Final m;
        decoder.read(m);
        break;
      }
      case MessageKind::Stop: {
        Stop m;
        decoder.read(m);
        break;
      }
      case MessageKind::Refusal: {
        Refusal m;
        decoder.read(m);
        break;
      }
      case MessageKind::Failure: {
        Failure m;
        decoder.read(m);
        break;
      }
      case MessageKind::Welcome: {
        Welcome m;
        decoder.read(m);
        break;
      }
      case MessageKind::Received:
        break;
    }
    return true;
  } catch (const Malformed& malformed) {
    EXPECT_GT(std::strlen(malformed.what()), 10u);
    return false;
  }
}

TEST(Wire, MutatedMessagesAreReadOrMalformedAndNothingElse) {
  Encoder encoder;
  std::vector<std::vector<std::byte>> seeds{
      copy(encoder.encode(make_awkward_motion())),
      copy(encoder.encode(Force{.step = 3, .force = make_awkward()})),
      copy(encoder.encode(make_join("ply_2"))),
      copy(encoder.encode(Final{.digest = 1, .energies = {}, .summary = {{"thinning", "-", 0.25}}})),
      copy(encoder.encode(Stop{StopReason::Lost, "why"})),
      copy(encoder.encode(Failure{"element 7 inverted"})),
      copy(encoder.encode(Refusal{"no"})),
      copy(encoder.encode(kWelcome)),
  };
  std::mt19937 random(20240601);
  Decoder decoder;
  int read = 0, malformed = 0;
  for (int trial = 0; trial < 200000; ++trial) {
    // an allocation of its own, so that a sanitizer sees any read beyond the end
    std::vector<std::byte> frame = seeds[random() % seeds.size()];
    const unsigned edits = 1 + random() % 4;
    for (unsigned k = 0; k < edits; ++k) {
      // mostly the prefix and the header: that is where lengths are
      const std::size_t reach = random() % 2 ? frame.size() : std::min<std::size_t>(frame.size(), 48);
      if (reach > 0) frame[random() % reach] = static_cast<std::byte>(random());
    }
    if (random() % 4 == 0) frame.resize(random() % (frame.size() + 24));
    frame.shrink_to_fit();
    ++(try_to_read(decoder, frame) ? read : malformed);
  }
  EXPECT_GT(read, 1000);
  EXPECT_GT(malformed, 1000);
}

TEST(Wire, AnotherVersionIsNamed) {
  Encoder encoder;
  Decoder decoder;
  auto frame = copy(encoder.encode(kWelcome));
  frame[3] = std::byte{9};
  EXPECT_THAT(get_message<Malformed>([&] { decoder.open(frame); }), HasSubstr("wire version 9"));
  frame[0] = std::byte{0};
  EXPECT_THAT(get_message<Malformed>([&] { decoder.open(frame); }), HasSubstr("does not start"));
}

}  // namespace
}  // namespace interply::exchange
