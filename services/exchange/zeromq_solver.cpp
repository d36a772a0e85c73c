#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <memory>
#include <optional>

#include "exchange/mailbox.hpp"
#include "exchange/wire.hpp"
#include "exchange/zeromq.hpp"
#include "exchange/zeromq_socket.hpp"

namespace interply::exchange {

namespace {

constexpr double kFailureDelivery = 2;  ///< s to wait until a failure has arrived
constexpr double kLastWords = 1.5;      ///< s to wait for a message of the coordinator when the mailbox is cut

class ZeromqSolver final : public SolverLink {
 public:
  explicit ZeromqSolver(const std::string& address) : address_(address) { socket_.connect(address); }

  Welcome join(const Join& join, double deadline) override {
    transmit(encoder_.encode(join));
    Welcome welcome;
    Refusal refusal;
    MailOffer offer;
    switch (*next(deadline)) {
      case MessageKind::Welcome:
        decoder_.read(welcome);
        decoder_.read(offer);
        mailbox_ = open_mailbox(address_, offer, socket_.descriptor());
        return welcome;
      case MessageKind::Refusal:
        decoder_.read(refusal);
        throw Refused(refusal.sentence);
      case MessageKind::Stop:
        throw_stopped();
      default:
        throw CoordinatorLost(fmt::format("the coordinator at {} answered a join with something else", address_));
    }
  }

  void send(const Motion& motion) override {
    step_ = motion.step;
    n_nodes_ = motion.position.cols();
    if (!mailbox_ || !mailbox_->post(motion)) transmit(encoder_.encode(motion));
  }

  void receive(Force& force, double deadline) override {
    const std::optional<MessageKind> kind = next(deadline, mailbox_.get());
    if (kind == MessageKind::Stop) throw_stopped();
    const bool fits = kind ? kind == MessageKind::Force && decoder_.step() == step_ && decoder_.n_nodes() == n_nodes_
                           : mailbox_->read(force) == step_;
    if (!fits)
      throw CoordinatorLost(fmt::format("the coordinator at {} answered step {} with something else", address_, step_));
    if (kind) decoder_.read(force);
  }

  void send(const Final& final) override { transmit(encoder_.encode(final)); }

  void send_failure(const std::string& message) override {
    try {
      transmit(encoder_.encode(Failure{message}));
      const Deadline until(kFailureDelivery);
      while (!until.passed()) {
        const std::optional<MessageKind> kind = next(kFailureDelivery);
        if (kind == MessageKind::Received || kind == MessageKind::Stop) return;
      }
    } catch (const CoordinatorLost&) {
      // nobody is left to be told
    }
  }

 private:
  void transmit(Bytes frame) {
    if (!socket_.send(frame))
      throw CoordinatorLost(
          fmt::format("cannot send to the coordinator at {} {}: {}", address_, where(), std::strerror(errno)));
  }

  /// Opens the next message, or says nothing because the answer is in the mailbox. @throws CoordinatorLost
  std::optional<MessageKind> next(double deadline, Mailbox* mailbox = nullptr) {
    Deadline until(deadline);
    bool cut = false;
    for (;;) {
      if (mailbox != nullptr && mailbox->has_mail()) return {};
      note_news();
      if (socket_.receive()) return open();
      if (lost_)
        throw CoordinatorLost(fmt::format("the coordinator at {} closed the connection {}", address_, where()));
      if (!cut && mailbox != nullptr && mailbox->is_cut()) {
        cut = true;  // a message may be on its way that says why
        until = std::min(until, Deadline(kLastWords));
      }
      if (until.passed())
        throw CoordinatorLost(
            cut ? fmt::format("the coordinator at {} closed the connection for arrays {}", address_, where())
                : fmt::format("no answer from the coordinator at {} for {:g} s {}", address_, deadline, where()));
      if (mailbox == nullptr) {
        socket_.wait(until);
        continue;
      }
      const pollfd mail = mailbox->announce_sleep();
      if (!mailbox->has_mail()) socket_.wait(until, {mail});
      mailbox->end_sleep();
    }
  }

  MessageKind open() {
    try {
      return decoder_.open(socket_.frame());
    } catch (const Malformed& malformed) {
      throw CoordinatorLost(fmt::format("the coordinator at {} is not understood: {}", address_, malformed.what()));
    }
  }

  /// A connection that once stood and ends is lost for good.
  void note_news() {
    while (const auto news = socket_.next_news()) {
      if (news->connected)
        connected_ = true;
      else if (connected_)
        lost_ = true;
    }
  }

  [[noreturn]] void throw_stopped() const {
    Stop stop;
    decoder_.read(stop);
    throw Stopped(stop.reason, stop.message);
  }

  std::string where() const { return step_ < 0 ? std::string("while joining") : fmt::format("at step {}", step_); }

  const std::string address_;
  ZeromqSocket socket_{ZeromqSocket::Type::Dealer};
  bool connected_ = false, lost_ = false;
  Encoder encoder_;
  Decoder decoder_;
  std::unique_ptr<Mailbox> mailbox_;  ///< null: everything travels as messages
  std::int64_t n_nodes_ = 0;
  std::int64_t step_ = -1;
};

}  // namespace

std::unique_ptr<SolverLink> connect_zeromq(const std::string& address) {
  return std::make_unique<ZeromqSolver>(address);
}

}  // namespace interply::exchange
