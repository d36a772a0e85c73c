/// Arrays between processes of one host, in memory that both ends map. Internal to exchange; messages (zeromq.hpp)
/// carry everything else and whatever a mailbox cannot take.
///
/// One memory file per run: a front page, then one area per participant with its mailbox, a Motion upwards and a Force
/// downwards. Lock-step needs no more: the solver posts motion n + 1 when it has force n, by which the coordinator says
/// that it has taken motion n. Counts of what was posted and answered tell whose turn it is; each is written by one end
/// only, after the arrays that it announces. Whoever has nothing to do sleeps on a bell (a pipe) beside its socket, so
/// that mail, messages and the end of a connection all wake it at once.
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

#include "exchange/link.hpp"

namespace interply::exchange {

/// What a Welcome says of the solver's mailbox (proto/exchange.proto).
struct MailboxOffer {
  int pid = 0;                                               ///< of the coordinator; 0: no mailbox
  int memory = -1, coordinator_bell = -1, solver_bell = -1;  ///< its file descriptors
  std::uint64_t token = 0;                                   ///< random; at the begin of the memory
  std::int64_t offset = 0;                                   ///< of the area in the memory, bytes
  std::int64_t n_nodes = 0;
};

/// A file descriptor, closed at the end.
class Descriptor {
 public:
  explicit Descriptor(int number = -1) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(other.number_) { other.number_ = -1; }
  Descriptor& operator=(Descriptor&&) = delete;
  ~Descriptor();
  int number() const { return number_; }

 private:
  int number_;
};

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

/// The numbers of a Motion; its arrays lie beside.
struct MotionMail {
  std::int64_t step;
  double vote;
  LayerEnergies energies;
  double step_seconds, wait_seconds;
  std::int64_t n_thickness;
};

struct MailboxArea;  ///< one participant's pages of the memory

/// The coordinator's end: one mailbox per participant.
class MailRoom {
 public:
  /// @throws std::system_error if the kernel gives no memory
  explicit MailRoom(const std::vector<Expected>& expected);

  MailboxOffer offer(int who) const;
  std::int64_t n_nodes(int who) const;
  /// A motion of `who` waits to be taken.
  bool has_mail(int who) const;
  /// Takes it. Its arrays may be read until the answer.
  MotionMail take(int who);
  /// @pre mail.n_thickness is 0 or the number of nodes
  void read(int who, const MotionMail& mail, Motion& motion) const;
  /// @pre `force` has the participant's number of nodes
  void answer(int who, const Force& force);
  Bell& bell() { return bell_; }

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
class Mailbox {
 public:
  /// @throws std::runtime_error says why it cannot be reached
  explicit Mailbox(const MailboxOffer& offer);

  /// False if the motion has another size or the last one has no answer yet: then it is a message's turn.
  bool post(const Motion& motion);
  /// The motion that was posted last has its answer, not yet read.
  bool has_mail() const;
  /// Takes the answer. @returns its step
  std::int64_t read(Force& force);
  Bell& bell() { return bell_; }

 private:
  MailboxArea& area() const;

  const std::int64_t n_nodes_;
  Descriptor memory_;
  Mapping front_, area_;
  Bell coordinator_, bell_;
  std::uint64_t posted_ = 0, read_ = 0;
};

}  // namespace interply::exchange
