/// One ZeroMQ socket and the news of its connections. Internal to exchange; zmq headers stay in zeromq_socket.cpp.
#pragma once

#include <poll.h>

#include <initializer_list>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "exchange/deadline.hpp"
#include "exchange/wire.hpp"

namespace interply::exchange {

/// `shm://path`: messages travel as over `ipc://path`, arrays in shared memory.
bool is_shared_memory(const std::string& address);
/// `tcp://host:port`: arrays have sockets of their own.
bool is_tcp(const std::string& address);

/// Used by one thread. What was sent before the end still leaves within a second.
class ZeromqSocket {
 public:
  enum class Type {
    Dealer,  ///< a solver: one connection
    Router   ///< the coordinator: many, told apart by an identity that ZeroMQ gives to each
  };
  explicit ZeromqSocket(Type type);
  ~ZeromqSocket();
  ZeromqSocket(const ZeromqSocket&) = delete;
  ZeromqSocket& operator=(const ZeromqSocket&) = delete;

  /// Larger messages end the connection they come from, bytes. Before bind().
  void limit_messages(std::int64_t bytes);
  /// Messages to one connection that may wait to leave. Before bind().
  void set_queue(int messages);
  /// Over TCP, whoever gives no sign of life for so long is silent: a cut link, a host that is gone, a process that is
  /// stopped. Whoever only computes is heard. Before bind() or connect(), s.
  void limit_silence(double seconds);
  /// Whether nothing has come by a connection for so long, in which this process itself was there to hear it: waited, and
  /// was not stopped. May be asked at any rate.
  /// @param connections  their descriptors; -1 is none   @return one that is silent, or -1
  int find_silent(std::span<const int> connections);
  /// @throws BadAddress, std::runtime_error
  void connect(const std::string& address);
  void bind(const std::string& address);
  /// What bind() took.
  std::string endpoint() const;

  /// Dealer; waits a few seconds at most. False: errno says why.
  bool send(Bytes frame);
  /// Router; never waits. False: that connection is gone, or it takes nothing any more.
  bool send(std::string_view identity, Bytes frame);

  /// Router; sends the message that receive() took on to another connection, without a copy. It is gone then. As
  /// send().
  bool relay(std::string_view identity);

  /// Takes the next message if one is here. What the next four describe is valid until the next call.
  bool receive();
  Bytes frame() const;
  bool is_whole() const;              ///< it had exactly one frame
  std::string_view identity() const;  ///< router: of the connection it came by
  int descriptor() const;             ///< file descriptor of that connection
  std::string peer_address() const;   ///< host, or user:group:process for ipc

  /// A connection was made (both ends have agreed to talk) or has ended.
  struct News {
    bool connected = false;  ///< else it ended
    int descriptor = -1;
  };
  /// All that was received by a connection is here before its end is told.
  std::optional<News> next_news();

  /// Sleeps until a message, news or one of `others` are there, at most until the deadline or its next look.
  /// @pre receive() and next_news() had nothing: what they leave behind does not wake   @pre at most two others
  void wait(const Deadline& until, std::initializer_list<pollfd> others = {});

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace interply::exchange
