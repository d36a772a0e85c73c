#include <algorithm>
#include <memory>
#include <optional>

#include "exchange/mailbox.hpp"
#include "exchange/zeromq.hpp"
#include "exchange/zeromq_client.hpp"

namespace interply::exchange {

namespace {

constexpr double kLastWords = 1.5;  ///< s to wait for a message of the coordinator when the mailbox is cut

class ZeromqSolver final : public SolverLink {
 public:
  ZeromqSolver(const std::string& address, double silence) : client_(address, silence) {}

  Welcome join(const Join& join, double deadline) override {
    MailOffer offer;
    const Welcome welcome = client_.join(join, deadline, offer);
    mailbox_ = open_mailbox(client_.address(), offer, client_.descriptor());
    return welcome;
  }

  void send(const Motion& motion) override {
    client_.step = motion.step;
    n_nodes_ = motion.position.cols();
    if (!mailbox_ || !mailbox_->post(motion)) client_.send(motion);
  }

  void receive(Force& force, double deadline) override {
    const std::optional<MessageKind> kind = mailbox_ ? next_or_mail(deadline) : client_.next(deadline);
    if (kind == MessageKind::Stop) client_.throw_stopped();
    const bool fits = kind ? kind == MessageKind::Force && client_.message().step() == client_.step &&
                                 client_.message().n_nodes() == n_nodes_
                           : mailbox_->read(force) == client_.step;
    if (!fits) client_.throw_lost("answered with something else");
    if (kind) client_.message().read(force);
  }

  void send(const Final& final) override { client_.send(final); }
  void send(const Sample& sample) override { client_.send(sample); }

  void wait_until_received(double deadline) override {
    if (client_.next(deadline) == MessageKind::Stop) client_.throw_stopped();
  }

  void send_failure(const std::string& message) override {
    client_.send_failure({.message = message});
  }

 private:
  /// The next message, or nothing because the answer is in the mailbox. @throws CoordinatorLost
  std::optional<MessageKind> next_or_mail(double deadline) {
    Deadline until(deadline);
    bool cut = false;
    for (;;) {
      if (mailbox_->has_mail()) return {};
      if (const auto kind = client_.take()) return kind;
      if (!cut && mailbox_->is_cut()) {
        cut = true;  // a message may be on its way that says why
        until = std::min(until, Deadline(kLastWords));
      }
      if (until.passed()) {
        if (cut) client_.throw_lost("closed the connection for arrays");
        client_.throw_silent(deadline);
      }
      const pollfd mail = mailbox_->announce_sleep();
      if (!mailbox_->has_mail()) client_.wait(until, {mail});
      mailbox_->end_sleep();
    }
  }

  ZeromqClient client_;
  std::unique_ptr<Mailbox> mailbox_;  ///< null: everything travels as messages
  std::int64_t n_nodes_ = 0;
};

}  // namespace

std::unique_ptr<SolverLink> connect_zeromq(const std::string& address, double silence) {
  return std::make_unique<ZeromqSolver>(address, silence);
}

}  // namespace interply::exchange
