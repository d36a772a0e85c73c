/// Mailboxes over TCP: one plain connection per solver for the arrays of each step, straight from and into them.
/// Internal to exchange.
///
/// The coordinator listens at the port after the one of its messages (any other if that is taken) at the same address.
/// A solver that was accepted connects there, at the host that its messages go to, and says the token of its Welcome;
/// the coordinator says that it has found the seat; from the next step on arrays go this way. Nobody waits for any of
/// this: until it is done, and for good if the port cannot be reached (a firewall, a container that forwards one port
/// only), arrays travel as messages, which is logged once. A message is, all of it little-endian:
///
///     solver -> coordinator   Hello          then per step  MotionHeader, position [3 x n], thickness [n] or none
///     coordinator -> solver   magic number   then per step  ForceHeader, force [3 x n]
///
/// Strangers have a token to guess and can hold nobody up: of those who have not said theirs sixteen are heard, the
/// oldest makes room. A connection that ends, or says what cannot be, loses the participant its place: it is cut.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "exchange/admission.hpp"
#include "exchange/deadline.hpp"
#include "exchange/descriptor.hpp"
#include "exchange/mailbox.hpp"
#include "exchange/stream.hpp"

namespace interply::exchange {

/// First eight bytes of either end, as the machine has them: another byte order or version does not match.
inline constexpr std::uint64_t kMailMagic = 0x3130'4c49'414d'5049;  // "IPMAIL01"

struct Hello {
  std::uint64_t magic = kMailMagic;
  std::uint64_t token = 0;
};
struct MotionHeader {
  std::int64_t n_nodes;
  MotionMail mail;
};
struct ForceHeader {
  std::int64_t n_nodes;
  ForceMail mail;
};
static_assert(sizeof(Hello) == 16 && sizeof(MotionHeader) == 80 && sizeof(ForceHeader) == 40, "no padding");

/// The coordinator's end.
class SocketMailRoom final : public MailRoom {
 public:
  /// @param endpoint  of the messages, tcp://ADDRESS:PORT with numbers   @throws std::system_error
  SocketMailRoom(const std::string& endpoint, const std::vector<Expected>& expected);

  MailOffer offer(int who) const override;
  std::int64_t n_nodes(int who) const override { return seat(who).n_nodes; }
  void look() override;
  bool has_mail(int who) const override { return seat(who).turn == Turn::Arrived; }
  MotionMail take(int who) override;
  void read(int who, const MotionMail& mail, Motion& motion) override;
  bool answer(int who, const Force& force) override;
  std::string why_cut(int who) const override { return seat(who).why_cut; }
  pollfd announce_sleep() override { return {epoll_.number(), POLLIN, 0}; }

 private:
  enum class Turn {
    Solver,       ///< to send a motion
    Arrived,      ///< it is here, whole
    Coordinator,  ///< it was taken; the answer is awaited
    Over          ///< the last answer was given: the connection may end
  };
  struct Seat {
    std::int64_t n_nodes = 0;
    std::uint64_t token = 0;
    std::optional<Stream> stream;
    Turn turn = Turn::Solver;
    MotionHeader header{};  ///< this and the next two are received into
    mechanics::NodalVectors position;
    mechanics::Scalars thickness;
    std::size_t filled = 0;  ///< of these, bytes
    std::string why_cut;
  };
  /// A connection that has not said its token.
  struct Stranger {
    Stream stream;
    Hello hello;
    std::size_t filled = 0;
  };
  Seat& seat(int who) { return seats_[static_cast<std::size_t>(who)]; }
  const Seat& seat(int who) const { return seats_[static_cast<std::size_t>(who)]; }

  /// @param name  what epoll calls the descriptor by   @param operation  of epoll_ctl()
  void watch(int descriptor, std::uint32_t events, std::uint64_t name, int operation) const;
  void accept_strangers();
  void hear(std::size_t slot);
  void admit(Stranger& stranger, std::size_t who);
  void serve(std::size_t who, std::uint32_t events);
  void receive(Seat& s);
  void cut(Seat& s, const std::string& why);

  Descriptor listener_, epoll_;
  int port_ = 0;
  std::vector<Seat> seats_;
  std::array<std::optional<Stranger>, 16> strangers_;
  std::size_t next_slot_ = 0;
  RefusalLog refusals_;
};

/// A solver's end.
class SocketMailbox final : public Mailbox {
 public:
  /// Begins to connect to the offered port at the other end of `connection`.   @throws std::system_error
  SocketMailbox(int connection, const SocketOffer& offer);

  bool post(const Motion& motion) override;
  bool has_mail() override;
  std::int64_t read(Force& force) override;
  bool is_cut() const override { return stage_ == Stage::Cut; }
  pollfd announce_sleep() override;

 private:
  enum class Stage {
    Connecting,
    Greeting,  ///< the hello is sent
    Ready,
    Unused,  ///< it did not come so far: messages only
    Cut      ///< was ready and has ended
  };
  /// Goes on with whatever the stage is.
  void look();
  void connect_on();
  void greet_on();
  void receive();
  void push();
  void give_up(const std::string& why);
  void cut();

  const std::int64_t n_nodes_;
  const Hello hello_;
  Deadline patience_;  ///< until the coordinator has answered the hello
  std::optional<Stream> stream_;
  Stage stage_ = Stage::Connecting;
  bool posted_ = false, arrived_ = false;  ///< a motion without an answer; its answer
  std::uint64_t magic_ = 0;
  ForceHeader header_{};  ///< this and the next are received into
  mechanics::NodalVectors force_;
  std::size_t filled_ = 0;  ///< of these (or of magic_), bytes
};

}  // namespace interply::exchange
