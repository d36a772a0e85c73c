/// Raw shared memory: one copy in, one copy out, and a futex to sleep on; no spinning, as processes share cores.
#include <fcntl.h>
#include <linux/futex.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <climits>
#include <ctime>
#include <string>
#include <system_error>
#include <vector>

#include "bench/carriers.hpp"

namespace interply::bench {
namespace {

using Word = std::atomic<std::uint32_t>;

long call_futex(Word& word, int operation, std::uint32_t value, const timespec* timeout) {
  return ::syscall(SYS_futex, reinterpret_cast<std::uint32_t*>(&word), operation, value, timeout, nullptr, 0);
}

/// Sleeps until the word is `wanted`.
void wait_for(Word& word, std::uint32_t wanted, const Watch& watch) {
  const timespec slice{0, static_cast<long>(1e9 * kSlice)};
  for (std::uint32_t now; (now = word.load(std::memory_order_acquire)) != wanted;)
    if (call_futex(word, FUTEX_WAIT, now, &slice) != 0 && errno == ETIMEDOUT) watch();
}

void set(Word& word, std::uint32_t value) {
  word.store(value, std::memory_order_release);
  call_futex(word, FUTEX_WAKE, INT_MAX, nullptr);
}

/// What lies in the shared memory: a word on which the hub sleeps, then one lane per peer.
struct Head {
  alignas(64) Word arrived;  ///< motions so far, of all peers
};
struct Lane {
  alignas(64) Word answered;  ///< forces so far
  std::int32_t last;
  alignas(64) double values[1];  ///< motion, then force; really 2 x 3 x n_nodes
};

class Memory {
 public:
  Memory(int descriptor, const StarSize& size) : descriptor_(descriptor), size_(size) {
    if (descriptor < 0) throw std::system_error(errno, std::generic_category(), "cannot open shared memory");
    if (::ftruncate(descriptor, static_cast<off_t>(bytes())) == 0)
      base_ = ::mmap(nullptr, bytes(), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_POPULATE, descriptor, 0);
    if (base_ == MAP_FAILED) {
      ::close(descriptor);
      throw std::system_error(errno, std::generic_category(), "cannot map shared memory");
    }
  }
  ~Memory() {
    ::munmap(base_, bytes());
    ::close(descriptor_);
  }
  Memory(const Memory&) = delete;
  Memory& operator=(const Memory&) = delete;

  int descriptor() const { return descriptor_; }
  Word& arrived() { return static_cast<Head*>(base_)->arrived; }
  Lane& lane(int peer) {
    return *reinterpret_cast<Lane*>(static_cast<char*>(base_) + sizeof(Head) +
                                    static_cast<std::size_t>(peer) * lane_bytes());
  }
  double* motion(int peer) { return lane(peer).values; }
  double* force(int peer) { return lane(peer).values + size_.values(); }

 private:
  std::size_t lane_bytes() const { return (sizeof(Lane) + sizeof(double) * 2 * size_.values() + 63) / 64 * 64; }
  std::size_t bytes() const { return sizeof(Head) + static_cast<std::size_t>(size_.peers) * lane_bytes(); }

  int descriptor_;
  StarSize size_;
  void* base_ = MAP_FAILED;
};

class MemoryHub final : public Hub {
 public:
  MemoryHub(const StarSize& size, Watch watch)
      : size_(size),
        watch_(std::move(watch)),
        memory_(::memfd_create("interply-bench", MFD_CLOEXEC), size),
        motion_(static_cast<std::size_t>(size.peers), std::vector<double>(size.values())),
        force_(motion_) {}
  /// Belongs to no folder: it is gone with the last process that has it.
  std::string address() const override {
    return "/proc/" + std::to_string(::getpid()) + "/fd/" + std::to_string(memory_.descriptor());
  }
  void accept() override {}
  void gather(std::int64_t step) override {
    wait_for(memory_.arrived(), static_cast<std::uint32_t>(size_.peers * (step + 1)), watch_);
    for (int p = 0; p < size_.peers; ++p)
      std::copy_n(memory_.motion(p), size_.values(), motion_[static_cast<std::size_t>(p)].data());
  }
  const double* motion(int peer) override { return motion_[static_cast<std::size_t>(peer)].data(); }
  double* force(int peer) override { return force_[static_cast<std::size_t>(peer)].data(); }
  void scatter(std::int64_t step, bool last) override {
    for (int p = 0; p < size_.peers; ++p) {
      std::copy_n(force(p), size_.values(), memory_.force(p));
      memory_.lane(p).last = last;
      set(memory_.lane(p).answered, static_cast<std::uint32_t>(step + 1));
    }
  }

 private:
  StarSize size_;
  Watch watch_;
  Memory memory_;
  std::vector<std::vector<double>> motion_, force_;
};

class MemoryPeer final : public Peer {
 public:
  MemoryPeer(const StarSize& size, int peer, const std::string& address, Watch watch)
      : size_(size),
        peer_(peer),
        watch_(std::move(watch)),
        memory_(::open(address.c_str(), O_RDWR | O_CLOEXEC), size),
        motion_(size.values()),
        force_(size.values()) {}
  double* motion() override { return motion_.data(); }
  const double* force() override { return force_.data(); }
  bool exchange(std::int64_t step) override {
    std::copy(motion_.begin(), motion_.end(), memory_.motion(peer_));
    const std::uint32_t arrived = memory_.arrived().fetch_add(1, std::memory_order_acq_rel) + 1;
    if (arrived == static_cast<std::uint32_t>(size_.peers * (step + 1)))
      call_futex(memory_.arrived(), FUTEX_WAKE, 1, nullptr);
    Lane& lane = memory_.lane(peer_);
    wait_for(lane.answered, static_cast<std::uint32_t>(step + 1), watch_);
    std::copy_n(memory_.force(peer_), size_.values(), force_.data());
    return lane.last != 0;
  }

 private:
  StarSize size_;
  int peer_;
  Watch watch_;
  Memory memory_;
  std::vector<double> motion_, force_;
};

}  // namespace

std::unique_ptr<Hub> make_memory_hub(const StarSize& size, const std::string&, const Watch& watch) {
  return std::make_unique<MemoryHub>(size, watch);
}
std::unique_ptr<Peer> connect_memory(const StarSize& size, int peer, const std::string& address, const Watch& watch) {
  return std::make_unique<MemoryPeer>(size, peer, address, watch);
}

}  // namespace interply::bench
