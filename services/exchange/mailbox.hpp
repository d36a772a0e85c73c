/// Ways for the arrays of a step beside the messages (zeromq.hpp), which carry everything else and whatever a mailbox
/// does not take: memory of one host (shared_mail.hpp) and TCP sockets of their own (socket_mail.hpp). Internal to
/// exchange.
///
/// Lock-step needs little: a solver posts motion n + 1 when it has force n, by which the coordinator says that it has
/// taken motion n. So there is room for one motion upwards and one force downwards.
#pragma once

#include <poll.h>

#include <cstdint>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "exchange/link.hpp"

namespace interply::exchange {

/// What a Welcome says of the solver's mailbox in shared memory (proto/exchange.proto).
struct MemoryOffer {
  int pid = 0;                                               ///< of the coordinator
  int memory = -1, coordinator_bell = -1, solver_bell = -1;  ///< its file descriptors
  std::uint64_t token = 0;                                   ///< random; at the begin of the memory
  std::int64_t offset = 0;                                   ///< of the area in the memory, bytes
  std::int64_t n_nodes = 0;
};

/// What a Welcome says of the solver's mailbox over TCP.
struct SocketOffer {
  int port = 0;             ///< at the host of the coordinator
  std::uint64_t token = 0;  ///< random, another one for each layer; the solver's first words there
  std::int64_t n_nodes = 0;
};

using MailOffer = std::variant<std::monostate, MemoryOffer, SocketOffer>;

/// The numbers of a Motion; its arrays lie beside.
struct MotionMail {
  std::int64_t step;
  double vote;
  LayerEnergies energies;
  double step_seconds, wait_seconds;
  std::int64_t n_thickness;
};

/// The numbers of a Force.
struct ForceMail {
  std::int64_t step;
  double time, next_dt;
  std::int32_t frame, last;
};

inline MotionMail make_mail(const Motion& m) {
  return {m.step, m.vote, m.energies, m.step_seconds, m.wait_seconds, m.thickness.size()};
}
inline void read(const MotionMail& mail, Motion& motion) {
  motion.step = mail.step;
  motion.vote = mail.vote;
  motion.energies = mail.energies;
  motion.step_seconds = mail.step_seconds;
  motion.wait_seconds = mail.wait_seconds;
}
inline ForceMail make_mail(const Force& f) { return {f.step, f.time, f.next_dt, f.frame, f.last}; }
inline void read(const ForceMail& mail, Force& force) {
  force.step = mail.step;
  force.time = mail.time;
  force.next_dt = mail.next_dt;
  force.frame = mail.frame;
  force.last = mail.last != 0;
}

/// The coordinator's end: one mailbox per participant. Nothing here waits.
class MailRoom {
 public:
  virtual ~MailRoom() = default;
  virtual MailOffer offer(int who) const = 0;
  virtual std::int64_t n_nodes(int who) const = 0;
  /// Looks for what has arrived.
  virtual void look() {}
  /// A motion of `who` waits to be taken.
  virtual bool has_mail(int who) const = 0;
  /// Takes it. Its arrays may be read once, until the answer. What it holds is not trusted.
  virtual MotionMail take(int who) = 0;
  /// @pre mail.n_thickness is 0 or the number of nodes
  virtual void read(int who, const MotionMail& mail, Motion& motion) = 0;
  /// False: the mailbox is cut.   @pre `force` has the participant's number of nodes
  virtual bool answer(int who, const Force& force) = 0;
  /// Why nothing more can come from `who` or reach it. Empty: the mailbox stands, or was never used.
  virtual std::string why_cut(int /*who*/) const { return {}; }
  /// What to sleep on; after this look for mail once more.
  virtual pollfd announce_sleep() = 0;
  virtual void end_sleep() {}
};

/// A solver's end. Nothing here waits, but for room in the kernel for a large motion.
class Mailbox {
 public:
  virtual ~Mailbox() = default;
  /// False if it is not ready, the motion has another size or the last one has no answer yet: then it is a message's
  /// turn.
  virtual bool post(const Motion& motion) = 0;
  /// The motion that was posted last has its answer, not yet read.
  virtual bool has_mail() = 0;
  /// Takes the answer. @returns its step
  virtual std::int64_t read(Force& force) = 0;
  /// No answer can come any more.
  virtual bool is_cut() const { return false; }
  /// What to sleep on; after this look for mail once more.
  virtual pollfd announce_sleep() = 0;
  virtual void end_sleep() {}
};

/// Random, for offers.
std::uint64_t make_token();

/// The mail room for a coordinator bound to `endpoint`; null (and one line in the log unless the address is one of
/// messages) if everything travels as messages.
std::unique_ptr<MailRoom> make_mail_room(const std::string& endpoint, const std::vector<Expected>& expected);

/// What a coordinator offers to a solver that connected to `address`; null as above.
/// @param connection  descriptor of the connection that the offer came by
std::unique_ptr<Mailbox> open_mailbox(const std::string& address, const MailOffer& offer, int connection);

}  // namespace interply::exchange
