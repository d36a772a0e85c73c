/// Ends of connections that say what a test wants.
#pragma once

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>

#include <atomic>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <list>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <zmq.hpp>

#include "exchange/descriptor.hpp"
#include "exchange/wire.hpp"

namespace interply::exchange {

/// A TCP socket that waits at most 20 s.
class RawTcp {
 public:
  static RawTcp listen(const std::string& host, int port) {
    RawTcp s;
    const int one = 1;
    ::setsockopt(s.descriptor(), SOL_SOCKET, SO_REUSEADDR, &one, sizeof(one));
    const sockaddr_in at = make_address(host, port);
    check(::bind(s.descriptor(), reinterpret_cast<const sockaddr*>(&at), sizeof(at)));
    check(::listen(s.descriptor(), 50));
    return s;
  }
  static RawTcp connect(const std::string& host, int port) {
    RawTcp s;
    const sockaddr_in at = make_address(host, port);
    check(::connect(s.descriptor(), reinterpret_cast<const sockaddr*>(&at), sizeof(at)));
    return s;
  }
  RawTcp accept() const { return RawTcp(::accept(descriptor(), nullptr, nullptr)); }

  int descriptor() const { return socket_.number(); }
  int port() const {
    sockaddr_in name{};
    socklen_t length = sizeof(name);
    ::getsockname(descriptor(), reinterpret_cast<sockaddr*>(&name), &length);
    return ntohs(name.sin_port);
  }
  void send_bytes(const void* data, std::size_t n) const {
    check(static_cast<int>(::send(descriptor(), data, n, MSG_NOSIGNAL)));
  }
  template <typename T>
  void send(const T& value) const {
    send_bytes(&value, sizeof(value));
  }
  template <typename T>
  T receive() const {
    T value{};
    EXPECT_EQ(::recv(descriptor(), &value, sizeof(value), MSG_WAITALL), static_cast<ssize_t>(sizeof(value)));
    return value;
  }
  bool has_ended() const {
    char byte;
    const ssize_t n = ::recv(descriptor(), &byte, 1, 0);
    return n == 0 || (n < 0 && errno == ECONNRESET);
  }
  /// Sends what is left, then closes in order.
  void end() const { ::shutdown(descriptor(), SHUT_RDWR); }

 private:
  explicit RawTcp(int descriptor = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) : socket_(descriptor) {
    check(descriptor);
    const timeval patience{20, 0};
    ::setsockopt(descriptor, SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof(patience));
  }
  static void check(int rc) {
    if (rc < 0) throw std::runtime_error(std::string("socket of a test: ") + std::strerror(errno));
  }
  static sockaddr_in make_address(const std::string& host, int port) {
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_port = htons(static_cast<std::uint16_t>(port));
    ::inet_pton(AF_INET, host.c_str(), &at.sin_addr);
    return at;
  }
  Descriptor socket_;
};

/// Forwards one TCP port of one address to the same port of another, as a container does.
class Forwarder {
 public:
  Forwarder(const std::string& host, int port, std::string to)
      : listener_(RawTcp::listen(host, port)), to_(std::move(to)), thread_([this, port] { run(port); }) {}
  ~Forwarder() {
    leave_ = true;
    thread_.join();
  }

 private:
  void run(int port) {
    std::list<std::pair<RawTcp, RawTcp>> pairs;
    while (!leave_) {
      pollfd wanted{listener_.descriptor(), POLLIN, 0};
      if (::poll(&wanted, 1, 1) > 0) pairs.emplace_back(listener_.accept(), RawTcp::connect(to_, port));
      for (const auto& [a, b] : pairs) {
        forward(a, b);
        forward(b, a);
      }
    }
  }
  static void forward(const RawTcp& from, const RawTcp& to) {
    char bytes[4096];
    const ssize_t n = ::recv(from.descriptor(), bytes, sizeof(bytes), MSG_DONTWAIT);
    if (n > 0) to.send_bytes(bytes, static_cast<std::size_t>(n));
  }
  RawTcp listener_;
  std::string to_;
  std::atomic<bool> leave_{false};
  std::thread thread_;
};

/// A solver's socket without a solver.
class RawDealer {
 public:
  explicit RawDealer(const std::string& endpoint) {
    socket_.set(zmq::sockopt::linger, 100);
    socket_.set(zmq::sockopt::rcvtimeo, 20000);
    socket_.connect(endpoint);
  }
  void send(Bytes frame) { socket_.send(zmq::const_buffer(frame.data(), frame.size()), zmq::send_flags::none); }
  MessageKind receive(Decoder& decoder) {
    if (!socket_.recv(frame_)) throw std::runtime_error("no message has come");
    return decoder.open({static_cast<const std::byte*>(frame_.data()), frame_.size()});
  }

 private:
  zmq::context_t context_;
  zmq::socket_t socket_{context_, zmq::socket_type::dealer};
  zmq::message_t frame_;
};

/// A coordinator's socket without a coordinator, for one solver.
class RawRouter {
 public:
  RawRouter() {
    socket_.set(zmq::sockopt::linger, 100);
    socket_.set(zmq::sockopt::rcvtimeo, 20000);
    socket_.bind("tcp://127.0.0.1:*");
  }
  std::string endpoint() const { return socket_.get(zmq::sockopt::last_endpoint); }
  MessageKind receive(Decoder& decoder) {
    if (!socket_.recv(identity_) || !socket_.recv(frame_)) throw std::runtime_error("no message has come");
    return decoder.open({static_cast<const std::byte*>(frame_.data()), frame_.size()});
  }
  void send(Bytes frame) {
    socket_.send(zmq::const_buffer(identity_.data(), identity_.size()), zmq::send_flags::sndmore);
    socket_.send(zmq::const_buffer(frame.data(), frame.size()), zmq::send_flags::none);
  }

 private:
  zmq::context_t context_;
  zmq::socket_t socket_{context_, zmq::socket_type::router};
  zmq::message_t identity_, frame_;
};

}  // namespace interply::exchange
