/// What the ends of a solver and of the recorder have in common: one connection to the coordinator. Internal to
/// exchange.
#pragma once

#include <optional>
#include <string>

#include "exchange/mailbox.hpp"
#include "exchange/wire.hpp"
#include "exchange/zeromq_socket.hpp"

namespace interply::exchange {

class ZeromqClient {
 public:
  /// @param silence  of the coordinator after which it counts as lost, s
  ZeromqClient(const std::string& address, double silence) : address_(address) {
    if (is_tcp(address)) socket_.limit_silence(silence);
    socket_.connect(address);
  }

  /// @param offer  receives what the coordinator offers for arrays
  Welcome join(const Join& join, double deadline, MailOffer& offer);

  /// @throws CoordinatorLost
  template <typename Message>
  void send(const Message& message) {
    transmit(encoder_.encode(message));
  }
  /// Opens the next message if one is here. @throws CoordinatorLost if none is and the connection has ended
  std::optional<MessageKind> take();
  /// The same, waiting for it. @throws CoordinatorLost also after `deadline` s
  MessageKind next(double deadline);
  /// Sleeps until something may be here. @pre take() had nothing
  void wait(const Deadline& until, std::initializer_list<pollfd> others = {}) { socket_.wait(until, others); }
  /// Sends why this participant cannot go on and waits briefly until that has arrived.
  void send_failure(const Failure& failure);

  /// Of the message that was opened last.
  const Decoder& message() const { return decoder_; }
  /// @pre it is a Stop
  [[noreturn]] void throw_stopped() const;

  const std::string& address() const { return address_; }
  int descriptor() const { return socket_.descriptor(); }
  /// What is wrong with the connection, where. @throws CoordinatorLost
  [[noreturn]] void throw_lost(const std::string& what) const;
  [[noreturn]] void throw_silent(double deadline) const;

  std::int64_t step = -1;               ///< for sentences, as is the next
  const char* stage = "while joining";  ///< where there is no step

 private:
  void transmit(Bytes frame);
  void note_news();
  std::string where() const;

  const std::string address_;
  ZeromqSocket socket_{ZeromqSocket::Type::Dealer};
  int descriptor_ = -1;  ///< of the connection, once it has brought something
  bool connected_ = false, lost_ = false;
  Encoder encoder_;
  Decoder decoder_;
};

}  // namespace interply::exchange
