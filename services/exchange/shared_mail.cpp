#include "exchange/shared_mail.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <numeric>
#include <stdexcept>
#include <string>
#include <system_error>

namespace interply::exchange {

namespace {

constexpr std::int64_t kPage = 1 << 16;  ///< bytes; a multiple of the page of any machine
constexpr const char* kName = "interply";
using Count = std::atomic<std::uint64_t>;
static_assert(Count::is_always_lock_free && Bell::Asleep::is_always_lock_free, "atomics work between processes");

/// First page of the memory.
struct Front {
  std::uint64_t token;
  alignas(64) Bell::Asleep coordinator_asleep;
};

std::int64_t round_up(std::int64_t bytes) { return (bytes + kPage - 1) / kPage * kPage; }

[[noreturn]] void fail(const std::string& what) { throw std::system_error(errno, std::generic_category(), what); }

}  // namespace

/// One participant's pages: this, then position [3 x n], thickness [n], force [3 x n].
struct MailboxArea {
  alignas(64) Count posted;  ///< motions, written by the solver
  MotionMail motion;
  alignas(64) Count answered;  ///< of these, written by the coordinator
  ForceMail force;
  alignas(64) Bell::Asleep solver_asleep;

  double* position() { return reinterpret_cast<double*>(this + 1); }
  double* thickness(std::int64_t n) { return position() + 3 * n; }
  double* force_array(std::int64_t n) { return position() + 4 * n; }
};

namespace {

std::int64_t compute_bytes(std::int64_t n_nodes) {
  return round_up(
      static_cast<std::int64_t>(sizeof(MailboxArea) + 7 * sizeof(double) * static_cast<std::size_t>(n_nodes)));
}

void copy(const double* from, double* to, Eigen::Index n) {
  if (n > 0) std::memcpy(to, from, sizeof(double) * static_cast<std::size_t>(n));
}

Descriptor make_memory(std::int64_t bytes) {
  Descriptor file(::memfd_create(kName, MFD_CLOEXEC | MFD_ALLOW_SEALING));
  if (file.number() < 0) fail("memfd_create");
  if (::fchmod(file.number(), 0600) != 0) fail("fchmod");
  if (const int error = ::posix_fallocate(file.number(), 0, bytes); error != 0)
    throw std::system_error(error, std::generic_category(), fmt::format("{} bytes of shared memory", bytes));
  if (::fcntl(file.number(), F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) != 0) fail("F_ADD_SEALS");
  return file;
}

/// A pipe behind one descriptor, for reading and writing.
Descriptor make_pipe() {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC | O_NONBLOCK) != 0) fail("pipe2");
  const Descriptor reading(ends[0]), writing(ends[1]);
  Descriptor both(::open(fmt::format("/proc/self/fd/{}", ends[0]).c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC));
  if (both.number() < 0) fail("open a pipe");
  return both;
}

/// Opens a descriptor of another process, if it leads to what it should: a number may mean another process here.
Descriptor open_of(int pid, int number, const std::string& kind) {
  const std::string path = fmt::format("/proc/{}/fd/{}", pid, number);
  char target[64] = {};
  if (::readlink(path.c_str(), target, sizeof(target) - 1) < 0) fail(path);
  if (!std::string(target).starts_with(kind)) throw std::runtime_error(path + " is of another process");
  Descriptor file(::open(path.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC | O_NOCTTY));
  if (file.number() < 0) fail(path);
  return file;
}

Descriptor open_memory(const MemoryOffer& offer) {
  if (offer.n_nodes < 0 || offer.n_nodes > INT64_C(1) << 40 || offer.offset < kPage || offer.offset % kPage != 0)
    throw std::runtime_error("the coordinator's offer makes no sense");
  Descriptor memory = open_of(offer.pid, offer.memory, fmt::format("/memfd:{}", kName));
  struct stat status {};
  if (::fstat(memory.number(), &status) != 0) fail("fstat");
  if (offer.offset > status.st_size - compute_bytes(offer.n_nodes))
    throw std::runtime_error("the coordinator's memory is smaller than it says");
  if ((::fcntl(memory.number(), F_GET_SEALS) & F_SEAL_SHRINK) == 0)
    throw std::runtime_error("the coordinator's memory may shrink");
  return memory;
}

Mapping map_front(int memory, std::uint64_t token) {
  Mapping front(memory, 0, kPage);
  if (front.as<Front>().token != token) throw std::runtime_error("the memory is that of another run");
  return front;
}

}  // namespace

Mapping::Mapping(int file, std::int64_t offset, std::int64_t bytes)
    : begin_(::mmap(nullptr, static_cast<std::size_t>(bytes), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, file,
                    offset)),
      bytes_(static_cast<std::size_t>(bytes)) {
  if (begin_ == MAP_FAILED) fail("mmap");
}

Mapping::~Mapping() {
  if (begin_ != nullptr) ::munmap(begin_, bytes_);
}

void Bell::end_sleep() {
  asleep_.store(0, std::memory_order_relaxed);
  char rings[64];
  while (::read(descriptor(), rings, sizeof(rings)) == sizeof(rings)) {
  }
}

void Bell::ring() {
  if (asleep_.load() == 0 || asleep_.exchange(0) == 0) return;
  const char one = 1;
  [[maybe_unused]] const auto written = ::write(descriptor(), &one, sizeof(one));  // fails only if it rings already
}

SharedMailRoom::Box::Box(int file, std::int64_t at, std::int64_t nodes)
    : offset(at),
      n_nodes(nodes),
      map(file, at, compute_bytes(nodes)),
      solver(map.as<MailboxArea>().solver_asleep, make_pipe()) {}

SharedMailRoom::SharedMailRoom(const std::vector<Expected>& expected)
    : token_(make_token()),
      memory_(make_memory(
          std::accumulate(expected.begin(), expected.end(), kPage,
                          [](std::int64_t bytes, const Expected& e) { return bytes + compute_bytes(e.n_nodes); }))),
      front_(memory_.number(), 0, kPage),
      bell_(front_.as<Front>().coordinator_asleep, make_pipe()) {
  front_.as<Front>().token = token_;
  boxes_.reserve(expected.size());
  std::int64_t offset = kPage;
  for (const Expected& e : expected) {
    boxes_.emplace_back(memory_.number(), offset, e.n_nodes);
    offset += compute_bytes(e.n_nodes);
  }
}

MailOffer SharedMailRoom::offer(int who) const {
  return MemoryOffer{.pid = ::getpid(),
                     .memory = memory_.number(),
                     .coordinator_bell = bell_.descriptor(),
                     .solver_bell = box(who).solver.descriptor(),
                     .token = token_,
                     .offset = box(who).offset,
                     .n_nodes = box(who).n_nodes};
}

std::int64_t SharedMailRoom::n_nodes(int who) const { return box(who).n_nodes; }

bool SharedMailRoom::has_mail(int who) const { return box(who).area().posted.load() != box(who).taken; }

MotionMail SharedMailRoom::take(int who) {
  Box& b = box(who);
  b.taken = b.area().posted.load();
  return b.area().motion;
}

void SharedMailRoom::read(int who, const MotionMail& mail, Motion& motion) {
  MailboxArea& area = box(who).area();
  const std::int64_t n = box(who).n_nodes;
  exchange::read(mail, motion);
  motion.position.resize(3, n);
  motion.thickness.resize(mail.n_thickness);
  copy(area.position(), motion.position.data(), 3 * n);
  copy(area.thickness(n), motion.thickness.data(), mail.n_thickness);
}

bool SharedMailRoom::answer(int who, const Force& force) {
  Box& b = box(who);
  MailboxArea& area = b.area();
  area.force = make_mail(force);
  copy(force.force.data(), area.force_array(b.n_nodes), force.force.size());
  area.answered.store(b.taken);
  b.solver.ring();
  return true;
}

pollfd SharedMailRoom::announce_sleep() {
  bell_.announce_sleep();
  return {bell_.descriptor(), POLLIN, 0};
}

SharedMailbox::SharedMailbox(const MemoryOffer& offer)
    : n_nodes_(offer.n_nodes),
      memory_(open_memory(offer)),
      front_(map_front(memory_.number(), offer.token)),
      area_(memory_.number(), offer.offset, compute_bytes(n_nodes_)),
      coordinator_(front_.as<Front>().coordinator_asleep, open_of(offer.pid, offer.coordinator_bell, "pipe:")),
      bell_(area().solver_asleep, open_of(offer.pid, offer.solver_bell, "pipe:")) {}

MailboxArea& SharedMailbox::area() const { return area_.as<MailboxArea>(); }

bool SharedMailbox::post(const Motion& motion) {
  const Eigen::Index n_thickness = motion.thickness.size();
  if (motion.position.cols() != n_nodes_ || (n_thickness != 0 && n_thickness != n_nodes_) || read_ != posted_)
    return false;
  area().motion = make_mail(motion);
  copy(motion.position.data(), area().position(), motion.position.size());
  copy(motion.thickness.data(), area().thickness(n_nodes_), n_thickness);
  area().posted.store(++posted_);
  coordinator_.ring();
  return true;
}

bool SharedMailbox::has_mail() { return read_ != posted_ && area().answered.load() == posted_; }

std::int64_t SharedMailbox::read(Force& force) {
  read_ = posted_;
  const ForceMail mail = area().force;
  exchange::read(mail, force);
  force.force.resize(3, n_nodes_);
  copy(area().force_array(n_nodes_), force.force.data(), force.force.size());
  return mail.step;
}

pollfd SharedMailbox::announce_sleep() {
  bell_.announce_sleep();
  return {bell_.descriptor(), POLLIN, 0};
}

}  // namespace interply::exchange
