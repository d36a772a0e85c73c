/// What every carrier must do, whatever lies between the two ends.
#include <array>
#include <bit>
#include <cstdlib>
#include <limits>
#include <new>
#include <set>

#include "exchange/carriers.hpp"

namespace {
thread_local long allocations = 0;
}

#ifndef __SANITIZE_ADDRESS__  // which has an operator new of its own
[[gnu::noinline]] void* operator new(std::size_t size) {
  ++allocations;
  if (void* p = std::malloc(size > 0 ? size : 1)) return p;
  throw std::bad_alloc();
}
[[gnu::noinline]] void operator delete(void* p) noexcept { std::free(p); }
[[gnu::noinline]] void operator delete(void* p, std::size_t) noexcept { std::free(p); }
#endif

namespace interply::exchange {
namespace {

using testing::HasSubstr;

class CarrierTest : public testing::TestWithParam<Carrier> {
 protected:
  Table make_table(std::vector<Expected> expected) { return Table(GetParam(), std::move(expected)); }
};

INSTANTIATE_TEST_SUITE_P(Carriers, CarrierTest,
                         testing::Values(Carrier::InProcess, Carrier::SharedMemory, Carrier::Ipc, Carrier::Tcp),
                         [](const auto& info) { return to_string(info.param); });

TEST_P(CarrierTest, JoinIsAcceptedAndSeatedByName) {
  Table table = make_table({{"sheet_lower", 4}, {"ply_1", 7}});
  auto link = table.connect();
  std::thread joining([&] { link->join(make_join("ply_1"), kPatience); });
  const Event event = table.coordinator().receive(kPatience);
  joining.join();
  EXPECT_EQ(event.kind, Event::Kind::Joined);
  EXPECT_EQ(event.who, 1);
  EXPECT_EQ(table.coordinator().joined(1).layer, "ply_1");
  EXPECT_EQ(table.coordinator().joined(1).pid, ::getpid());
}

TEST_P(CarrierTest, EveryRefusalIsASentenceForThePeerAndALineInTheLog) {
  const LogCapture log;
  Table table = make_table({{"sheet_lower", 4}, {"ply_1", 7}, {"ply_2", 7}});
  std::unique_ptr<SolverLink> first = join_as(table, "ply_1");

  struct Case {
    Join join;
    std::string sentence;
  };
  std::vector<Case> cases{{make_join("ply_3"), "the nearest is \"ply_"},
                          {make_join("sheet_lover"), "the nearest is \"sheet_lower\""},
                          {make_join("ply_2"), "0.0.9"},
                          {make_join("ply_2"), "digest 0000000000000001"},
                          {make_join("ply_1"), "has joined before"}};
  cases[2].join.version = "0.0.9";
  cases[3].join.scene_digest = 1;
  for (const Case& c : cases) {
    const std::string said = get_refusal(table, c.join);
    EXPECT_THAT(said, HasSubstr(c.sentence));
    EXPECT_THAT(log.text(), HasSubstr(c.sentence));
  }
  EXPECT_EQ(log.count("is refused, the run goes on"), static_cast<int>(cases.size()));

  // and the run goes on
  std::unique_ptr<SolverLink> second = join_as(table, "ply_2");
  first->send(make_motion(1, 7, 0));
  EXPECT_EQ(table.coordinator().receive(kPatience).kind, Event::Kind::Moved);
}

TEST_P(CarrierTest, ArraysKeepEveryBitBothWays) {
  Table table = make_table({{"ply_1", 2}});
  auto link = join_as(table, "ply_1");
  Motion motion;
  motion.step = 0;
  motion.vote = std::bit_cast<double>(0x7ff8000000000007ull);
  motion.energies = {.kinetic = 1, .internal = -0.0, .internal_work = 3, .contact_work = 4};
  motion.position.resize(3, 2);
  motion.position << std::bit_cast<double>(0x7ff8dead0000beefull), -0.0, std::numeric_limits<double>::denorm_min(),
      -std::numeric_limits<double>::infinity(), std::bit_cast<double>(0xfff0000000000001ull), 0.1;
  motion.thickness = mechanics::Scalars::LinSpaced(2, 0.3, 0.4);
  link->send(motion);
  const Event event = table.coordinator().receive(kPatience);
  ASSERT_EQ(event.kind, Event::Kind::Moved);
  ASSERT_EQ(event.who, 0);
  const Motion& got = table.coordinator().motion(0);
  EXPECT_TRUE(same_bits(got.position, motion.position));
  EXPECT_TRUE(same_bits(got.thickness, motion.thickness));
  EXPECT_EQ(std::bit_cast<std::uint64_t>(got.vote), std::bit_cast<std::uint64_t>(motion.vote));
  EXPECT_EQ(std::memcmp(&got.energies, &motion.energies, sizeof(LayerEnergies)), 0);

  Force force{.step = 0, .time = 0.1, .next_dt = 0x1.fp-24, .frame = 3, .last = false, .force = motion.position};
  EXPECT_TRUE(table.coordinator().send(0, force));
  Force answer;
  link->receive(answer, kPatience);
  EXPECT_EQ(answer.step, 0);
  EXPECT_EQ(answer.time, 0.1);
  EXPECT_EQ(answer.next_dt, 0x1.fp-24);
  EXPECT_EQ(answer.frame, 3);
  EXPECT_FALSE(answer.last);
  EXPECT_TRUE(same_bits(answer.force, force.force));

  motion.step = 1;
  motion.thickness.resize(0);
  link->send(motion);
  ASSERT_EQ(table.coordinator().receive(kPatience).kind, Event::Kind::Moved);
  EXPECT_EQ(table.coordinator().motion(0).thickness.size(), 0) << "unchanged thickness is not sent again";
}

TEST_P(CarrierTest, FivePeersInLockStepNeverSeeAStaleArray) {
  constexpr int kPeers = 5;
  constexpr std::int64_t kSteps = 1000;
  std::vector<Expected> expected;
  for (int i = 0; i < kPeers; ++i) expected.push_back({"layer_" + std::to_string(i), 200 + 37 * i});
  Table table = make_table(expected);
  const auto n = [&](int i) { return static_cast<Eigen::Index>(expected[static_cast<std::size_t>(i)].n_nodes); };

  std::array<std::int64_t, kPeers> good{};
  std::vector<std::thread> solvers;
  for (int i = 0; i < kPeers; ++i)
    solvers.emplace_back([&, i] {
      auto link = table.connect();
      link->join(make_join(expected[static_cast<std::size_t>(i)].layer), kPatience);
      Force force;
      for (std::int64_t step = 0; step <= kSteps; ++step) {
        link->send(make_motion(i, n(i), step));
        link->receive(force, kPatience);
        if (force.step == step && force.last == (step == kSteps) && is_filled(force.force, n(i), i + 100, step))
          ++good[static_cast<std::size_t>(i)];
      }
      link->send(
          Final{.digest = static_cast<std::uint64_t>(i) + 1, .energies = {}, .summary = {{"thinning", "-", 0.5}}});
    });

  CoordinatorLink& coordinator = table.coordinator();
  int joined = 0, ended = 0, arrived = 0, bad = 0;
  std::int64_t step = 0;
  while (ended < kPeers) {
    const Event event = coordinator.receive(kPatience);
    if (event.kind == Event::Kind::Joined) {
      ++joined;
    } else if (event.kind == Event::Kind::Moved) {
      if (++arrived < kPeers) continue;
      for (int i = 0; i < kPeers; ++i)
        if (coordinator.motion(i).step != step || !is_filled(coordinator.motion(i).position, n(i), i, step)) ++bad;
      for (int i = 0; i < kPeers; ++i) EXPECT_TRUE(coordinator.send(i, make_force(i, n(i), step, step == kSteps)));
      ++step;
      arrived = 0;
    } else if (event.kind == Event::Kind::Ended) {
      ++ended;
      EXPECT_EQ(event.final.digest, static_cast<std::uint64_t>(event.who) + 1);
      EXPECT_EQ(event.final.summary.at(0).name, "thinning");
    } else {
      ADD_FAILURE() << "unexpected event " << static_cast<int>(event.kind) << ": " << event.message;
      coordinator.stop(StopReason::Lost, "test failed");
      break;
    }
  }
  for (auto& s : solvers) s.join();
  EXPECT_EQ(joined, kPeers);
  EXPECT_EQ(step, kSteps + 1);
  EXPECT_EQ(bad, 0);
  for (const auto g : good) EXPECT_EQ(g, kSteps + 1);
  EXPECT_EQ(coordinator.receive(0.2).kind, Event::Kind::None) << "leaving after the end is no suspicion";
}

TEST_P(CarrierTest, ALargeLayerPasses) {
  constexpr Eigen::Index kNodes = 300000;  // beyond every buffer of the kernel
  Table table = make_table({{"ply_1", kNodes}});
  auto link = join_as(table, "ply_1");
  constexpr std::int64_t kLast = 5;
  int good = 0;
  std::thread solver([&] {
    Force force;
    for (std::int64_t step = 0; step <= kLast; ++step) {
      Motion motion = make_motion(0, kNodes, step);
      if (step % 2 == 0) motion.thickness = mechanics::Scalars::Constant(kNodes, static_cast<double>(step));
      link->send(motion);
      link->receive(force, kPatience);
      good += is_filled(force.force, kNodes, 100, step);
    }
    link->send(Final{});
  });
  CoordinatorLink& coordinator = table.coordinator();
  for (std::int64_t step = 0; step <= kLast; ++step) {
    EXPECT_EQ(coordinator.receive(kPatience).kind, Event::Kind::Moved);
    EXPECT_TRUE(is_filled(coordinator.motion(0).position, kNodes, 0, step));
    EXPECT_EQ(coordinator.motion(0).thickness.size(), step % 2 == 0 ? kNodes : 0);
    EXPECT_TRUE((coordinator.motion(0).thickness == static_cast<double>(step)).all());
    EXPECT_TRUE(coordinator.send(0, make_force(0, kNodes, step, step == kLast)));
  }
  EXPECT_EQ(coordinator.receive(kPatience).kind, Event::Kind::Ended);
  solver.join();
  EXPECT_EQ(good, kLast + 1);
}

TEST_P(CarrierTest, TheCoordinatorMayReadAMotionAfterItHasAnswered) {
  Table table = make_table({{"ply_1", 50}});
  auto link = join_as(table, "ply_1");
  std::thread solver([&] {
    Force force;
    for (int step = 0; step < 200; ++step) {
      link->send(make_motion(0, 50, step));
      link->receive(force, kPatience);
    }
    link->send(make_motion(0, 50, 200));
  });
  for (int step = 0; step < 200; ++step) {
    ASSERT_EQ(table.coordinator().receive(kPatience).kind, Event::Kind::Moved);
    table.coordinator().send(0, make_force(0, 50, step));
    std::this_thread::yield();
    EXPECT_TRUE(is_filled(table.coordinator().motion(0).position, 50, 0, step));
  }
  solver.join();
}

TEST_P(CarrierTest, AStepAllocatesNothing) {
  Table table = make_table({{"ply_1", 500}});
  auto link = join_as(table, "ply_1");
  Motion motion = make_motion(0, 500, 0);
  motion.thickness = mechanics::Scalars::Constant(500, 0.3);
  Force answer = make_force(0, 500, 0), got;
  std::set<const double*> places;  // arrays do not come from operator new
  for (int step = 0; step < 100; ++step) {
    motion.step = answer.step = step;
    const long before = allocations;
    link->send(motion);
    ASSERT_EQ(table.coordinator().receive(kPatience).kind, Event::Kind::Moved);
    table.coordinator().send(0, answer);
    link->receive(got, kPatience);
    const long after = allocations;
    if (step < 3) continue;
    EXPECT_EQ(after - before, 0) << "at step " << step;
    places.insert({got.force.data(), table.coordinator().motion(0).position.data(),
                   table.coordinator().motion(0).thickness.data()});
  }
#ifndef __SANITIZE_ADDRESS__
  EXPECT_GT(allocations, 0) << "the counter counts";
#endif
  EXPECT_LE(places.size(), 6u) << "three arrays with two places each at most";
}

TEST_P(CarrierTest, MessagesOutOfTurnAreRefusedAndChangeNothing) {
  const LogCapture log;
  Table table = make_table({{"ply_1", 5}});
  auto link = join_as(table, "ply_1");
  CoordinatorLink& coordinator = table.coordinator();
  link->send(make_motion(0, 6, 0));  // another size
  link->send(make_motion(0, 5, -3));
  EXPECT_EQ(coordinator.receive(0.2).kind, Event::Kind::None);
  link->send(make_motion(0, 5, 0));
  ASSERT_EQ(coordinator.receive(kPatience).kind, Event::Kind::Moved);
  link->send(make_motion(9, 5, 0));  // not its turn
  link->send(make_motion(9, 5, 1));
  link->send(Final{});
  EXPECT_EQ(coordinator.receive(0.2).kind, Event::Kind::None);
  EXPECT_TRUE(is_filled(coordinator.motion(0).position, 5, 0, 0));
  EXPECT_EQ(log.count("motion"), 1) << "one line per peer and kind\n" << log.text();
  EXPECT_EQ(log.count("final message before the last step"), 1);
  if (GetParam() != Carrier::InProcess) link->send(make_motion(0, 5, 0));  // refused; sets the solver's step back
  coordinator.send(0, make_force(0, 5, 0));
  Force force;
  link->receive(force, kPatience);
  EXPECT_EQ(force.step, 0);
}

TEST_P(CarrierTest, StopReachesEveryoneWithItsReason) {
  Table table = make_table({{"ply_1", 5}, {"ply_2", 5}, {"ply_3", 5}});
  auto a = join_as(table, "ply_1"), b = join_as(table, "ply_2"), c = join_as(table, "ply_3");
  a->send(make_motion(0, 5, 0));
  ASSERT_EQ(table.coordinator().receive(kPatience).kind, Event::Kind::Moved);
  table.coordinator().stop(StopReason::Diverged, "ply_2 inverted element 7");
  for (SolverLink* link : {a.get(), b.get(), c.get()}) {
    Force force;
    try {
      link->receive(force, kPatience);
      ADD_FAILURE() << "not stopped";
    } catch (const Stopped& stopped) {
      EXPECT_EQ(stopped.reason, StopReason::Diverged);
      EXPECT_STREQ(stopped.what(), "ply_2 inverted element 7");
    }
  }
  a.reset();
  b.reset();
  EXPECT_EQ(table.coordinator().receive(0.2).kind, Event::Kind::None) << "leaving when told to is no suspicion";
  EXPECT_EQ(get_refusal<Stopped>(table, make_join("ply_1")), "ply_2 inverted element 7") << "who comes too late is told";
}

TEST_P(CarrierTest, StopStillLeavesWhenTheCoordinatorEndsAtOnce) {
  Table table = make_table({{"ply_1", 5}});
  auto link = join_as(table, "ply_1");
  table.coordinator().stop(StopReason::Cancelled, "interrupted");
  table.end_coordinator();
  Force force;
  EXPECT_EQ(get_message<Stopped>([&] { link->receive(force, kPatience); }), "interrupted");
}

TEST_P(CarrierTest, CancelWakesAWaitingCoordinatorFromAnyThread) {
  Table table = make_table({{"ply_1", 5}});
  std::thread other([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    table.coordinator().cancel("interrupted");
  });
  const Event event = table.coordinator().receive(kPatience);
  other.join();
  EXPECT_EQ(event.kind, Event::Kind::Cancelled);
  EXPECT_EQ(event.message, "interrupted");
  table.coordinator().cancel("again");
  EXPECT_EQ(table.coordinator().receive(kPatience).message, "again") << "a coming receive() returns at once";
  EXPECT_EQ(table.coordinator().receive(0.05).kind, Event::Kind::None);
}

TEST_P(CarrierTest, AFailureArrivesWithItsMessage) {
  Table table = make_table({{"ply_1", 5}, {"ply_2", 5}});
  auto a = join_as(table, "ply_1"), b = join_as(table, "ply_2");
  b->send(make_motion(1, 5, 0));
  std::thread failing([&] {
    b->send_failure("ply_2: element 7 inverted at 3 ms");
    b.reset();
  });
  Event event = table.coordinator().receive(kPatience);
  EXPECT_EQ(event.kind, Event::Kind::Moved);
  event = table.coordinator().receive(kPatience);
  failing.join();
  EXPECT_EQ(event.kind, Event::Kind::Failed);
  EXPECT_EQ(event.who, 1);
  EXPECT_EQ(event.message, "ply_2: element 7 inverted at 3 ms");
  EXPECT_FALSE(table.coordinator().send(1, make_force(1, 5, 0))) << "it is gone";
  EXPECT_EQ(table.coordinator().receive(0.2).kind, Event::Kind::None) << "no suspicion on top of the failure";
}

TEST_P(CarrierTest, WaitingForNobodyEndsAtTheDeadline) {
  Table table = make_table({{"ply_1", 5}});
  auto link = join_as(table, "ply_1");
  EXPECT_EQ(table.coordinator().receive(0.05).kind, Event::Kind::None);
  EXPECT_EQ(table.coordinator().receive(0).kind, Event::Kind::None);
  link->send(make_motion(0, 5, 0));
  Force force;
  const std::string said = get_message<CoordinatorLost>([&] { link->receive(force, 0.1); });
  EXPECT_THAT(said, HasSubstr("for 0.1 s at step 0"));
  EXPECT_THAT(said, HasSubstr(table.endpoint()));
}

TEST_P(CarrierTest, ASolverThatLeavesEarlyIsSuspectByName) {
  Table table = make_table({{"ply_1", 5}, {"ply_2", 5}, {"ply_3", 5}});
  auto a = join_as(table, "ply_1"), b = join_as(table, "ply_2"), c = join_as(table, "ply_3");
  b->send(make_motion(1, 5, 0));
  b.reset();
  EXPECT_EQ(table.coordinator().receive(1).kind, Event::Kind::Moved) << "what it still said comes first";
  const Event event = table.coordinator().receive(1);
  EXPECT_EQ(event.kind, Event::Kind::Suspect);
  EXPECT_EQ(event.who, 1);
  EXPECT_THAT(event.message, HasSubstr("ply_2"));
  EXPECT_FALSE(table.coordinator().send(1, make_force(1, 5, 0)));
  EXPECT_EQ(table.coordinator().receive(0.1).kind, Event::Kind::None) << "said once";
  a->send(make_motion(0, 5, 0));
  EXPECT_EQ(table.coordinator().receive(kPatience).kind, Event::Kind::Moved);
}

TEST_P(CarrierTest, TheEndOfTheCoordinatorIsNoticedByEverySolver) {
  Table table = make_table({{"ply_1", 5}, {"ply_2", 5}});
  auto a = join_as(table, "ply_1"), b = join_as(table, "ply_2");
  std::array<std::string, 2> said;
  std::array<SolverLink*, 2> links{a.get(), b.get()};
  std::vector<std::thread> waiting;
  for (std::size_t i = 0; i < 2; ++i)
    waiting.emplace_back([&, i] {
      links[i]->send(make_motion(static_cast<int>(i), 5, 0));
      Force force;
      said[i] = get_message<CoordinatorLost>([&] { links[i]->receive(force, kPatience); });
    });
  table.coordinator().receive(kPatience);
  table.coordinator().receive(kPatience);
  table.end_coordinator();
  for (auto& w : waiting) w.join();
  for (const auto& s : said) {
    EXPECT_THAT(s, HasSubstr("at step 0"));
    EXPECT_THAT(s, testing::Not(HasSubstr("no answer"))) << "noticed, not timed out";
  }
}

}  // namespace
}  // namespace interply::exchange
