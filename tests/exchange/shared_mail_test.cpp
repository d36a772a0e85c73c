/// Shared memory: who may reach it, what happens to those who cannot, and that nobody has to trust it.
#include "exchange/shared_mail.hpp"

#include <fcntl.h>
#include <grp.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/wait.h>

#include <array>
#include <set>

#include "exchange/carriers.hpp"

namespace interply::exchange {
namespace {

using testing::HasSubstr;

std::string without_memory(std::string address) { return address.replace(0, 3, "ipc"); }

TEST(SharedMail, MotionAndForceCrossAndTurnsAreKept) {
  SharedMailRoom room({{"ply_1", 3}, {"ply_2", 7}});
  SharedMailbox box(std::get<MemoryOffer>(room.offer(1)));
  EXPECT_FALSE(room.has_mail(1));
  EXPECT_FALSE(box.has_mail());
  EXPECT_FALSE(box.post(make_motion(1, 6, 0))) << "of another size";
  ASSERT_TRUE(box.post(make_motion(1, 7, 0)));
  EXPECT_FALSE(box.post(make_motion(1, 7, 1))) << "not its turn";
  EXPECT_FALSE(room.has_mail(0));
  ASSERT_TRUE(room.has_mail(1));
  const MotionMail mail = room.take(1);
  EXPECT_FALSE(room.has_mail(1));
  Motion motion;
  room.read(1, mail, motion);
  EXPECT_EQ(motion.step, 0);
  EXPECT_TRUE(is_filled(motion.position, 7, 1, 0));
  EXPECT_FALSE(box.has_mail());
  room.answer(1, make_force(1, 7, 0, true));
  ASSERT_TRUE(box.has_mail());
  EXPECT_FALSE(box.post(make_motion(1, 7, 1))) << "the answer is not read yet";
  Force force;
  EXPECT_EQ(box.read(force), 0);
  EXPECT_TRUE(force.last);
  EXPECT_TRUE(is_filled(force.force, 7, 101, 0));
  EXPECT_TRUE(box.post(make_motion(1, 7, 1)));
}

TEST(SharedMail, AnOfferThatLeadsElsewhereIsRefused) {
  const SharedMailRoom room({{"ply_1", 3}}), other({{"ply_1", 3}});
  const auto good = std::get<MemoryOffer>(room.offer(0));
  EXPECT_NO_THROW(SharedMailbox{good});
  const auto said = [&](auto change) {
    MemoryOffer offer = good;
    change(offer);
    return get_message<std::exception>([&] { SharedMailbox{offer}; });
  };
  EXPECT_THAT(said([](auto& o) { o.pid = 4194304; }), HasSubstr("/proc/4194304/fd"));
  EXPECT_THAT(said([](auto& o) { o.memory = 0; }), HasSubstr("of another process"));
  EXPECT_THAT(said([](auto& o) { o.memory = 1 << 20; }), HasSubstr("No such file"));
  EXPECT_THAT(said([](auto& o) { o.solver_bell = o.memory; }), HasSubstr("of another process"));
  EXPECT_THAT(said([&](auto& o) { o.memory = std::get<MemoryOffer>(other.offer(0)).memory; }),
              HasSubstr("another run"));
  EXPECT_THAT(said([](auto& o) { o.n_nodes = 1 << 20; }), HasSubstr("smaller than it says"));
  EXPECT_THAT(said([](auto& o) { o.n_nodes = -1; }), HasSubstr("makes no sense"));
  EXPECT_THAT(said([](auto& o) { o.n_nodes = INT64_MAX; }), HasSubstr("makes no sense"));
  EXPECT_THAT(said([](auto& o) { o.offset = INT64_MIN; }), HasSubstr("makes no sense"));
  EXPECT_THAT(said([](auto& o) { o.offset = 1 << 30; }), HasSubstr("smaller than it says"));
  EXPECT_THAT(said([](auto& o) { o.offset += 8; }), HasSubstr("makes no sense"));
}

TEST(SharedMail, TheMemoryIsPrivateNamelessAndCannotShrink) {
  const SharedMailRoom room({{"ply_1", 3}});
  const int file = std::get<MemoryOffer>(room.offer(0)).memory;
  struct stat status {};
  ASSERT_EQ(::fstat(file, &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0600u);
  EXPECT_EQ(status.st_nlink, 0u) << "no folder holds it: it ends with the last process";
  EXPECT_NE(::ftruncate(file, 0), 0);
  EXPECT_EQ(::fcntl(file, F_GET_SEALS) & (F_SEAL_SHRINK | F_SEAL_GROW), F_SEAL_SHRINK | F_SEAL_GROW);
}

TEST(SharedMail, SomeShareMemoryAndSomeSendMessages) {
  constexpr Eigen::Index kNodes = 100;
  constexpr std::int64_t kLast = 300;
  Table table(Carrier::SharedMemory, {{"ply_0", kNodes}, {"ply_1", kNodes}, {"ply_2", kNodes}});
  std::array<bool, 3> good{};
  std::array<std::unique_ptr<SolverLink>, 3> links;  // that nobody leaves before the others are done
  std::vector<std::thread> solvers;
  for (int i = 0; i < 3; ++i)
    solvers.emplace_back([&, i] {
      auto& link = links[static_cast<std::size_t>(i)];
      link = connect_zeromq(i == 1 ? without_memory(table.endpoint()) : table.endpoint());
      link->join(make_join("ply_" + std::to_string(i)), kPatience);
      good[static_cast<std::size_t>(i)] = advance(*link, i, kNodes, kLast);
    });
  EXPECT_TRUE(answer_all(table.coordinator(), 3, kNodes, kLast));
  for (auto& s : solvers) s.join();
  EXPECT_THAT(good, testing::Each(true));
}

TEST(SharedMail, ASolverThatAsksForMemoryMayMeetACoordinatorWithout) {
  Table table(Carrier::Ipc, {{"ply_0", 9}});
  auto link = connect_zeromq("shm" + table.endpoint().substr(3));
  std::thread solver([&] {
    link->join(make_join("ply_0"), kPatience);
    EXPECT_TRUE(advance(*link, 0, 9, 3));
  });
  EXPECT_TRUE(answer_all(table.coordinator(), 1, 9, 3));
  solver.join();
}

TEST(SharedMail, AnotherUserFallsBackToMessagesAndSaysSo) {
  if (::geteuid() != 0) GTEST_SKIP() << "needs root to become another user";
  int pipe[2], call[2];
  ASSERT_EQ(::pipe(pipe), 0);
  ASSERT_EQ(::pipe(call), 0);
  const pid_t child = ::fork();  // before there are threads, which may hold locks that the child would wait for
  if (child == 0) {
    ::dup2(pipe[1], STDOUT_FILENO);  // where the log goes
    ::close(call[1]);
    bool good = false;
    try {
      char endpoint[1000] = {};
      if (::read(call[0], endpoint, sizeof(endpoint) - 1) > 0 && ::setgroups(0, nullptr) == 0 && ::setgid(65534) == 0 &&
          ::setuid(65534) == 0) {
        auto link = connect_zeromq(endpoint);
        link->join(make_join("ply_0"), kPatience);
        good = advance(*link, 0, 9, 3);
      }
    } catch (const std::exception&) {
    }
    std::fflush(stdout);
    ::_exit(good ? 0 : 1);
  }
  Table table(Carrier::SharedMemory, {{"ply_0", 9}});
  ::chmod(table.endpoint().substr(6).c_str(), 0777);  // the socket is shared with everyone, the memory is not
  ASSERT_GT(::write(call[1], table.endpoint().data(), table.endpoint().size()), 0);
  ::close(pipe[1]);
  EXPECT_TRUE(answer_all(table.coordinator(), 1, 9, 3));
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_EQ(status, 0);
  char said[1000] = {};
  ASSERT_GT(::read(pipe[0], said, sizeof(said) - 1), 0);
  EXPECT_THAT(said, HasSubstr("shared memory cannot be used"));
  EXPECT_THAT(said, HasSubstr("Permission denied"));
  EXPECT_THAT(said, HasSubstr("travel as messages"));
  for (const int end : {pipe[0], call[0], call[1]}) ::close(end);
}

TEST(SharedMail, GarbageInTheMemoryIsRefusedLikeAMalformedMessage) {
  const LogCapture log;
  Table table(Carrier::SharedMemory, {{"ply_0", 9}, {"ply_1", 9}});
  auto link = join_as(table, "ply_1");
  CoordinatorLink& coordinator = table.coordinator();
  int memory = -1;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fd")) {
    std::error_code gone;
    if (std::filesystem::read_symlink(entry, gone).string().starts_with("/memfd:interply"))
      memory = std::stoi(entry.path().filename());
  }
  ASSERT_GE(memory, 0);
  struct stat status {};
  ASSERT_EQ(::fstat(memory, &status), 0);
  const auto size = static_cast<std::size_t>(status.st_size);
  auto* bytes = static_cast<unsigned char*>(::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, memory, 0));
  ASSERT_NE(bytes, MAP_FAILED);
  for (const unsigned char garbage : {0xff, 0x01, 0x7f}) {
    std::memset(bytes, garbage, size);
    EXPECT_EQ(coordinator.receive(0.05).kind, Event::Kind::None);
  }
  EXPECT_EQ(log.count("sent a motion of"), 1) << log.text();
  // and the run goes on, for the one whose memory it was too
  std::thread solver([&] { EXPECT_TRUE(advance(*link, 1, 9, 3)); });
  EXPECT_TRUE(answer_all(coordinator, 1, 9, 3));
  solver.join();
  ::munmap(bytes, size);
}

}  // namespace
}  // namespace interply::exchange
