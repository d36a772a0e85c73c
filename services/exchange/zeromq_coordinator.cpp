#include <fmt/format.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <mutex>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "exchange/admission.hpp"
#include "exchange/mailbox.hpp"
#include "exchange/wire.hpp"
#include "exchange/zeromq.hpp"
#include "exchange/zeromq_socket.hpp"
#include "process/words.hpp"

namespace interply::exchange {

namespace {

Event make_event(Event::Kind kind, int who, std::string message = {}) {
  Event event;
  event.kind = kind;
  event.who = who;
  event.message = std::move(message);
  return event;
}

/// Wakes a thread that sleeps on a descriptor; ring() is for any thread.
class Alarm {
 public:
  Alarm() : descriptor_(::eventfd(0, EFD_NONBLOCK | EFD_CLOEXEC)) {
    if (descriptor_ < 0) throw std::system_error(errno, std::generic_category(), "eventfd");
  }
  ~Alarm() { ::close(descriptor_); }
  Alarm(const Alarm&) = delete;
  Alarm& operator=(const Alarm&) = delete;

  int descriptor() const { return descriptor_; }
  void ring(const std::string& message) {
    const std::lock_guard lock(mutex_);
    message_ = message;
    rung_ = true;
    const std::uint64_t one = 1;
    [[maybe_unused]] const auto written = ::write(descriptor_, &one, sizeof(one));  // fails only if it rings already
  }
  std::optional<std::string> take() {
    if (!rung_) return {};
    std::uint64_t count;
    if (::read(descriptor_, &count, sizeof(count)) < 0) return {};
    const std::lock_guard lock(mutex_);
    rung_ = false;
    return message_;
  }

 private:
  const int descriptor_;
  std::atomic<bool> rung_ = false;
  std::mutex mutex_;
  std::string message_;
};

constexpr std::size_t kLongestMessage = 2000, kLongestName = 100;  ///< bytes that a participant may say
constexpr int kQueuePerSeat = 100;  ///< messages; the recorder gets some of every layer for each frame under way

class ZeromqCoordinator final : public CoordinatorLink {
 public:
  ZeromqCoordinator(const std::string& address, Welcome welcome, const std::vector<Expected>& expected, ArraysBy arrays,
                    bool recorder, double silence)
      : welcome_(std::move(welcome)),
        admission_(welcome_.scene_digest, expected, recorder),
        peers_(static_cast<std::size_t>(admission_.size())) {
    socket_.limit_messages(
        std::max(compute_frame_limit(admission_.largest_layer()), compute_sample_limit(admission_.largest_sample())));
    socket_.set_queue(kQueuePerSeat * (2 + admission_.size()));
    if (is_tcp(address)) socket_.limit_silence(silence);
    socket_.bind(address);
    if (arrays == ArraysBy::Mailbox) mail_ = make_mail_room(socket_.endpoint(), expected);
  }

  Event receive(double timeout) override {
    Deadline until(timeout);
    for (;;) {
      if (auto message = alarm_.take()) return make_event(Event::Kind::Cancelled, -1, std::move(*message));
      if (n_owed_ > 0) {  // mail that never ceases must not keep messages from being read
        if (Event event = read_messages(until); event.kind != Event::Kind::None) return event;
      }
      if (Event event = read_mail(); event.kind != Event::Kind::None) return event;
      // a loss is told after all that the lost one still sent
      if (Event event = read_messages(until); event.kind != Event::Kind::None) return event;
      if (Event event = take_loss(); event.kind != Event::Kind::None) return event;
      if (until.passed()) return {};
      sleep(until);
    }
  }

  const Motion& motion(int who) const override { return peer(who).motion; }
  const Join& joined(int who) const override { return admission_.join(who); }

  bool send(int who, const Force& force) override {
    if (!admission_.note_answer(who, force)) return false;
    if (force.frame >= 0 && expects_recorder()) {
      ++peer(who).owed;
      ++n_owed_;
    }
    if (peer(who).by_mail) return mail_->answer(who, force);
    if (socket_.send(peer(who).identity, encoder_.encode(force))) return true;
    peer(who).lost = true;
    return false;
  }

  void stop(StopReason reason, const std::string& message) override {
    admission_.close(message);
    stopped_ = Stop{reason, message};
    const Bytes frame = encoder_.encode(*stopped_);
    for (int who = 0; who < admission_.n_layers(); ++who)
      if (admission_.is_active(who)) socket_.send(peer(who).identity, frame);
  }

  void cancel(const std::string& message) override { alarm_.ring(message); }

  bool expects_recorder() const override { return admission_.recorder() >= 0; }

  void send(const Sample& sample) override {
    const int who = admission_.recorder();
    if (who < 0 || !admission_.is_active(who)) return;
    bytes_recorded_ += static_cast<std::int64_t>(sample.payload.size());
    if (!socket_.send(peer(who).identity, encoder_.encode(sample))) peer(who).lost = true;
  }

  bool owes_sample(int who) const override { return peer(who).owed > 0; }
  std::int64_t bytes_recorded() const override { return bytes_recorded_; }

  std::string endpoint() const { return socket_.endpoint(); }

 private:
  struct Peer {
    std::string identity;  ///< of its connection; empty: not joined
    int descriptor = -1;   ///< of its connection, as the monitor will name it
    bool lost = false;     ///< and not yet told
    bool by_mail = false;  ///< its last motion came by its mailbox: so does the answer
    int owed = 0;          ///< frames that it was told to publish and has not yet
    Motion motion;
  };
  Peer& peer(int who) { return peers_[static_cast<std::size_t>(who)]; }
  const Peer& peer(int who) const { return peers_[static_cast<std::size_t>(who)]; }

  void note_news() {
    while (const auto news = socket_.next_news()) note_end(news->descriptor);
    connections_.clear();
    for (const Peer& p : peers_) connections_.push_back(p.descriptor);
    note_end(socket_.find_silent(connections_));
  }
  void note_end(int descriptor) {
    for (Peer& p : peers_)
      if (p.descriptor >= 0 && p.descriptor == descriptor) {
        p.lost = true;
        p.descriptor = -1;
      }
  }

  Event take_loss() {
    for (int who = 0; who < admission_.size(); ++who) {
      if (!admission_.is_active(who) || has_mail(who)) continue;
      const std::string why = mail_ && who < admission_.n_layers() ? mail_->why_cut(who) : std::string();
      if ((peer(who).lost || !why.empty()) && admission_.note_gone(who))
        return make_event(Event::Kind::Suspect, who,
                          fmt::format("the connection to {} was lost{}{}", describe(admission_.join(who)),
                                      why.empty() ? "" : ": ", why));
    }
    return {};
  }

  bool has_mail(int who) const {
    return mail_ && who < admission_.n_layers() && admission_.is_active(who) && mail_->has_mail(who);
  }
  bool has_mail() const {
    for (int who = 0; who < admission_.n_layers(); ++who)
      if (has_mail(who)) return true;
    return false;
  }

  void sleep(const Deadline& until) {
    const pollfd alarm{alarm_.descriptor(), POLLIN, 0};
    if (!mail_) return socket_.wait(until, {alarm});
    const pollfd mail = mail_->announce_sleep();
    if (!has_mail()) socket_.wait(until, {alarm, mail});
    mail_->end_sleep();
  }

  /// Takes one motion from the mailboxes.
  Event read_mail() {
    if (!mail_) return {};
    if (!has_mail()) mail_->look();
    for (int who = 0; who < admission_.n_layers(); ++who) {
      if (!has_mail(who)) continue;
      const MotionMail mail = mail_->take(who);
      const std::string refusal = admission_.judge_motion(who, mail.step, mail_->n_nodes(who), mail.n_thickness);
      if (!refusal.empty()) {
        refuse(who, "motion", refusal);
        continue;
      }
      mail_->read(who, mail, peer(who).motion);
      peer(who).by_mail = true;
      return make_event(Event::Kind::Moved, who);
    }
    return {};
  }

  /// Connections are looked at before each message because a descriptor may be used again.
  Event read_messages(Deadline& until) {
    while (note_news(), socket_.receive()) {
      if (Event event = read_message(); event.kind != Event::Kind::None) return event;
      if (until.passed()) break;
    }
    return {};
  }

  /// Reads the message that the socket has taken. None: it was refused or handed on.
  Event read_message() {
    const int who = find(socket_.identity());
    if (!socket_.is_whole()) return refuse(who, "parts", "sent a message of several parts");
    try {
      const MessageKind kind = decoder_.open(socket_.frame());
      if (kind == MessageKind::Join) return read_join(who);
      if (who < 0) return refuse(who, "stranger", "sent a message without having joined");
      return read_from(who, kind);
    } catch (const Malformed& malformed) {
      if (who < 0) socket_.send(socket_.identity(), encoder_.encode(Refusal{malformed.what()}));
      return refuse(who, "malformed", fmt::format("sent a malformed message: {}", malformed.what()));
    }
  }

  Event read_join(int known) {
    Join join;
    decoder_.read(join);
    if (known >= 0) return refuse(known, "join", "sent a second join");
    const std::string identity(socket_.identity());
    if (stopped_) {  // no fault of whoever comes late
      socket_.send(identity, encoder_.encode(*stopped_));
      return {};
    }
    const Admission::Verdict verdict = admission_.judge(join);
    if (verdict.who < 0) {
      socket_.send(identity, encoder_.encode(Refusal{verdict.refusal}));
      return refuse(-1, verdict.refusal, fmt::format("sent a join: {}", verdict.refusal));
    }
    Peer& p = peer(verdict.who);
    p.identity = identity;
    p.descriptor = socket_.descriptor();
    const bool has_mailbox = mail_ && verdict.who < admission_.n_layers();
    if (!socket_.send(identity, encoder_.encode(welcome_, has_mailbox ? mail_->offer(verdict.who) : MailOffer{})))
      p.lost = true;
    return make_event(Event::Kind::Joined, verdict.who);
  }

  Event read_from(int who, MessageKind kind) {
    Event event;
    event.who = who;
    std::string refusal;
    switch (kind) {
      case MessageKind::Motion:
        refusal = admission_.judge_motion(who, decoder_.step(), decoder_.n_nodes(), decoder_.n_thickness());
        if (!refusal.empty()) return refuse(who, "motion", refusal);
        decoder_.read(peer(who).motion);
        peer(who).by_mail = false;
        event.kind = Event::Kind::Moved;
        return event;
      case MessageKind::Final:
        refusal = admission_.judge_final(who);
        if (!refusal.empty()) return refuse(who, "final", refusal);
        decoder_.read(event.final);
        for (SummaryItem& item : event.final.summary) {
          item.name = process::to_line(item.name, kLongestName);
          item.unit = process::to_line(item.unit, kLongestName);
        }
        socket_.send(peer(who).identity, encoder_.encode(Received{}));
        event.kind = Event::Kind::Ended;
        return event;
      case MessageKind::Failure: {
        refusal = admission_.judge_failure(who);
        if (!refusal.empty()) return refuse(who, "failure", refusal);
        Failure failure;
        decoder_.read(failure);
        socket_.send(peer(who).identity, encoder_.encode(Received{}));
        event.kind = Event::Kind::Failed;
        event.reason = who == admission_.recorder() ? failure.reason : StopReason::Diverged;
        event.message = process::to_line(failure.message, kLongestMessage);
        return event;
      }
      case MessageKind::Sample: {
        Sample sample;
        decoder_.read(sample);
        refusal = admission_.judge_sample(who, sample);
        if (!refusal.empty()) return refuse(who, "sample", refusal);
        hand_on(who, sample);
        return event;
      }
      case MessageKind::Recorded:
        decoder_.read(event.recorded);
        refusal = admission_.judge_recorded(who, event.recorded.closed);
        if (!refusal.empty()) return refuse(who, "recorded", refusal);
        event.kind = Event::Kind::Recorded;
        return event;
      default:
        return refuse(who, "direction", "sent a message that only a coordinator sends");
    }
  }

  /// To the recorder, as it is.
  void hand_on(int who, const Sample& sample) {
    if (sample.frame >= 0 && peer(who).owed > 0) {
      --peer(who).owed;
      --n_owed_;
    }
    bytes_recorded_ += static_cast<std::int64_t>(sample.payload.size());
    const int recorder = admission_.recorder();
    if (admission_.is_active(recorder) && !socket_.relay(peer(recorder).identity)) peer(recorder).lost = true;
  }

  /// @returns Kind::None
  Event refuse(int who, const std::string& kind, const std::string& sentence) {
    const std::string name = who >= 0 ? describe(admission_.join(who)) : "a stranger at " + socket_.peer_address();
    refusals_.warn(name, kind, sentence);
    return {};
  }

  /// Participant of a connection, or -1.
  int find(std::string_view identity) const {
    for (std::size_t i = 0; i < peers_.size(); ++i)
      if (peers_[i].identity == identity) return static_cast<int>(i);
    return -1;
  }

  const Welcome welcome_;
  Admission admission_;
  RefusalLog refusals_;
  std::vector<Peer> peers_;
  std::vector<int> connections_;  ///< of the peers
  Alarm alarm_;
  ZeromqSocket socket_{ZeromqSocket::Type::Router};
  Encoder encoder_;
  Decoder decoder_;
  std::optional<Stop> stopped_;
  std::unique_ptr<MailRoom> mail_;  ///< null: everything travels as messages
  int n_owed_ = 0;                  ///< of all peers
  std::int64_t bytes_recorded_ = 0;
};

}  // namespace

std::unique_ptr<CoordinatorLink> bind_zeromq(const std::string& address, Welcome welcome,
                                             std::vector<Expected> expected, ArraysBy arrays, bool recorder,
                                             double silence) {
  return std::make_unique<ZeromqCoordinator>(address, std::move(welcome), expected, arrays, recorder, silence);
}

std::string get_endpoint(const CoordinatorLink& link) {
  return dynamic_cast<const ZeromqCoordinator&>(link).endpoint();
}

}  // namespace interply::exchange
