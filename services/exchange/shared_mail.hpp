/// Mailboxes in memory that both ends map, between processes of one host. Internal to exchange.
///
/// One memory file per run: a front page, then one area per participant with its mailbox, a Motion upwards and a Force
/// downwards. Counts of what was posted and answered tell whose turn it is; each is written by one end only, after the
/// arrays that it announces. Whoever has nothing to do sleeps on a bell (a pipe) beside its socket, so that mail,
/// messages and the end of a connection all wake it at once.
///
/// The memory file has no name and its size is sealed: nothing is left behind by a killed process and nobody can take
/// memory away under the other. A solver reaches it as /proc/<coordinator>/fd/<n>: only processes of the same user that
/// see the coordinator under the same number can. What it holds is still not trusted: numbers are copied, then checked.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "exchange/descriptor.hpp"
#include "exchange/mailbox.hpp"

namespace interply::exchange {

/// A part of a memory file, mapped.
class Mapping {
 public:
  /// @throws std::system_error
  Mapping(int file, std::int64_t offset, std::int64_t bytes);
  Mapping(Mapping&& other) noexcept : begin_(other.begin_), bytes_(other.bytes_) { other.begin_ = nullptr; }
  Mapping& operator=(Mapping&&) = delete;
  ~Mapping();
  template <typename T>
  T& as(std::int64_t offset = 0) const {
    return *reinterpret_cast<T*>(static_cast<std::byte*>(begin_) + offset);
  }

 private:
  void* begin_;
  std::size_t bytes_;
};

/// Wakes one process that has announced to sleep; costs nothing while it is awake. No ring is missed: the sleeper
/// announces, then looks for mail; the other end puts mail, then looks for the announcement; all four in one order
/// (sequentially consistent), so that one of them sees the other. It sleeps at once: on a host with fewer free cores
/// than participants, looking for 20 us first made a step take twice as long.
class Bell {
 public:
  using Asleep = std::atomic<std::uint32_t>;  ///< in the shared memory
  Bell(Asleep& asleep, Descriptor pipe) : asleep_(asleep), pipe_(std::move(pipe)) {}
  /// After this a ring() reaches the descriptor: look for mail once more before sleeping.
  void announce_sleep() { asleep_.store(1); }
  void end_sleep();
  void ring();
  int descriptor() const { return pipe_.number(); }

 private:
  Asleep& asleep_;
  Descriptor pipe_;  ///< open for reading and writing at both ends
};

struct MailboxArea;  ///< one participant's pages of the memory

/// The coordinator's end: one mailbox per participant.
class SharedMailRoom final : public MailRoom {
 public:
  /// @throws std::system_error if the kernel gives no memory
  explicit SharedMailRoom(const std::vector<Expected>& expected);

  MailOffer offer(int who) const override;
  std::int64_t n_nodes(int who) const override;
  bool has_mail(int who) const override;
  MotionMail take(int who) override;
  void read(int who, const MotionMail& mail, Motion& motion) override;
  bool answer(int who, const Force& force) override;
  pollfd announce_sleep() override;
  void end_sleep() override { bell_.end_sleep(); }

 private:
  struct Box {
    Box(int file, std::int64_t offset, std::int64_t n_nodes);
    MailboxArea& area() const { return map.as<MailboxArea>(); }

    std::int64_t offset, n_nodes;
    Mapping map;
    Bell solver;
    std::uint64_t taken = 0;  ///< motions
  };
  Box& box(int who) { return boxes_[static_cast<std::size_t>(who)]; }
  const Box& box(int who) const { return boxes_[static_cast<std::size_t>(who)]; }

  const std::uint64_t token_;
  Descriptor memory_;
  Mapping front_;
  Bell bell_;
  std::vector<Box> boxes_;
};

/// A solver's end.
class SharedMailbox final : public Mailbox {
 public:
  /// @throws std::runtime_error says why it cannot be reached
  explicit SharedMailbox(const MemoryOffer& offer);

  bool post(const Motion& motion) override;
  bool has_mail() override;
  std::int64_t read(Force& force) override;
  pollfd announce_sleep() override;
  void end_sleep() override { bell_.end_sleep(); }

 private:
  MailboxArea& area() const;

  const std::int64_t n_nodes_;
  Descriptor memory_;
  Mapping front_, area_;
  Bell coordinator_, bell_;
  std::uint64_t posted_ = 0, read_ = 0;
};

}  // namespace interply::exchange
