/// Raw sockets: what a stream socket costs at least, one send per participant and direction.
#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include "bench/carriers.hpp"

namespace interply::bench {
namespace {

constexpr int kKernelBuffer = 4 << 20;  ///< bytes; a whole message fits
constexpr std::size_t kHeader = 2;      ///< step and `last`, as doubles before the array

class Socket {
 public:
  Socket() = default;  ///< none yet
  explicit Socket(int descriptor) : descriptor_(descriptor) {
    if (descriptor < 0) throw std::system_error(errno, std::generic_category(), "socket");
  }
  ~Socket() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  Socket(Socket&& other) noexcept : descriptor_(std::exchange(other.descriptor_, -1)) {}
  Socket& operator=(Socket&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
  }
  int get() const { return descriptor_; }

 private:
  int descriptor_ = -1;
};

void check(int rc, const char* what) {
  if (rc < 0) throw std::system_error(errno, std::generic_category(), what);
}

void prepare(const Socket& s, bool tcp) {
  timeval slice{0, static_cast<int>(1e6 * kSlice)};
  const int one = 1;
  check(::setsockopt(s.get(), SOL_SOCKET, SO_RCVTIMEO, &slice, sizeof slice), "SO_RCVTIMEO");
  check(::setsockopt(s.get(), SOL_SOCKET, SO_SNDTIMEO, &slice, sizeof slice), "SO_SNDTIMEO");
  check(::setsockopt(s.get(), SOL_SOCKET, SO_SNDBUF, &kKernelBuffer, sizeof kKernelBuffer), "SO_SNDBUF");
  check(::setsockopt(s.get(), SOL_SOCKET, SO_RCVBUF, &kKernelBuffer, sizeof kKernelBuffer), "SO_RCVBUF");
  if (tcp) check(::setsockopt(s.get(), IPPROTO_TCP, TCP_NODELAY, &one, sizeof one), "TCP_NODELAY");
}

/// Moves all bytes with `call`(pointer, bytes), looking around after each slice without progress.
template <typename Call>
void move_all(void* data, std::size_t bytes, const Watch& watch, const char* what, const Call& call) {
  auto* at = static_cast<char*>(data);
  while (bytes > 0) {
    const ssize_t n = call(at, bytes);
    if (n == 0) throw std::runtime_error("the other end of a socket has closed it");
    if (n < 0) {
      if (errno != EAGAIN && errno != EWOULDBLOCK && errno != EINTR)
        throw std::system_error(errno, std::generic_category(), what);
      watch();
      continue;
    }
    at += n;
    bytes -= static_cast<std::size_t>(n);
  }
}

/// Step, `last` and array as they cross the socket.
class Message {
 public:
  explicit Message(const StarSize& size) : buffer_(kHeader + size.values()) {}
  double* values() { return buffer_.data() + kHeader; }
  bool last() const { return buffer_[1] != 0; }
  void send(const Socket& s, std::int64_t step, bool last, const Watch& watch) {
    buffer_[0] = static_cast<double>(step);
    buffer_[1] = last;
    move_all(buffer_.data(), bytes(), watch, "send",
             [&](void* at, std::size_t n) { return ::send(s.get(), at, n, MSG_NOSIGNAL); });
  }
  void receive(const Socket& s, std::int64_t step, const Watch& watch) {
    move_all(buffer_.data(), bytes(), watch, "recv",
             [&](void* at, std::size_t n) { return ::recv(s.get(), at, n, MSG_WAITALL); });
    if (buffer_[0] != static_cast<double>(step)) throw std::runtime_error("a message of another step has arrived");
  }

 private:
  std::size_t bytes() const { return sizeof(double) * buffer_.size(); }
  std::vector<double> buffer_;
};

class SocketHub final : public Hub {
 public:
  SocketHub(const StarSize& size, const std::string& folder, bool tcp, Watch watch)
      : size_(size),
        tcp_(tcp),
        watch_(std::move(watch)),
        listener_(::socket(tcp ? AF_INET : AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)),
        motion_(static_cast<std::size_t>(size.peers), Message(size)),
        force_(motion_) {
    prepare(listener_, tcp);  // accepted sockets inherit the buffers
    if (tcp) {
      sockaddr_in name{.sin_family = AF_INET, .sin_addr = {htonl(INADDR_LOOPBACK)}};
      socklen_t length = sizeof name;
      check(::bind(listener_.get(), reinterpret_cast<sockaddr*>(&name), length), "bind");
      check(::getsockname(listener_.get(), reinterpret_cast<sockaddr*>(&name), &length), "getsockname");
      address_ = std::to_string(ntohs(name.sin_port));
    } else {
      address_ = folder + "/raw";
      sockaddr_un name{.sun_family = AF_UNIX};
      address_.copy(name.sun_path, sizeof name.sun_path - 1);
      check(::bind(listener_.get(), reinterpret_cast<sockaddr*>(&name), sizeof name), "bind");
    }
    check(::listen(listener_.get(), size.peers), "listen");
  }

  std::string address() const override { return address_; }

  void accept() override {
    peers_.resize(static_cast<std::size_t>(size_.peers));
    for (int i = 0; i < size_.peers; ++i) {
      pollfd wanted{listener_.get(), POLLIN, 0};
      while (::poll(&wanted, 1, static_cast<int>(1e3 * kSlice)) <= 0) watch_();
      Socket socket(::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC));
      prepare(socket, tcp_);
      std::int32_t who = -1;
      move_all(&who, sizeof who, watch_, "recv",
               [&](void* at, std::size_t n) { return ::recv(socket.get(), at, n, MSG_WAITALL); });
      if (who < 0 || who >= size_.peers) throw std::runtime_error("a stranger has connected");
      peers_[static_cast<std::size_t>(who)] = std::move(socket);
    }
  }
  void gather(std::int64_t step) override {
    for (std::size_t i = 0; i < peers_.size(); ++i) motion_[i].receive(peers_[i], step, watch_);
  }
  const double* motion(int peer) override { return motion_[static_cast<std::size_t>(peer)].values(); }
  double* force(int peer) override { return force_[static_cast<std::size_t>(peer)].values(); }
  void scatter(std::int64_t step, bool last) override {
    for (std::size_t i = 0; i < peers_.size(); ++i) force_[i].send(peers_[i], step, last, watch_);
  }

 private:
  StarSize size_;
  bool tcp_;
  Watch watch_;
  Socket listener_;
  std::string address_;
  std::vector<Message> motion_, force_;
  std::vector<Socket> peers_;
};

class SocketPeer final : public Peer {
 public:
  SocketPeer(const StarSize& size, int peer, const std::string& address, bool tcp, Watch watch)
      : watch_(std::move(watch)),
        socket_(::socket(tcp ? AF_INET : AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)),
        motion_(size),
        force_(size) {
    prepare(socket_, tcp);
    if (tcp) {
      sockaddr_in name{.sin_family = AF_INET,
                       .sin_port = htons(static_cast<std::uint16_t>(std::stoi(address))),
                       .sin_addr = {htonl(INADDR_LOOPBACK)}};
      check(::connect(socket_.get(), reinterpret_cast<sockaddr*>(&name), sizeof name), "connect");
    } else {
      sockaddr_un name{.sun_family = AF_UNIX};
      address.copy(name.sun_path, sizeof name.sun_path - 1);
      check(::connect(socket_.get(), reinterpret_cast<sockaddr*>(&name), sizeof name), "connect");
    }
    std::int32_t who = peer;
    move_all(&who, sizeof who, watch_, "send",
             [&](void* at, std::size_t n) { return ::send(socket_.get(), at, n, MSG_NOSIGNAL); });
  }
  double* motion() override { return motion_.values(); }
  const double* force() override { return force_.values(); }
  bool exchange(std::int64_t step) override {
    motion_.send(socket_, step, false, watch_);
    force_.receive(socket_, step, watch_);
    return force_.last();
  }

 private:
  Watch watch_;
  Socket socket_;
  Message motion_, force_;
};

}  // namespace

std::unique_ptr<Hub> make_unix_hub(const StarSize& size, const std::string& folder, const Watch& watch) {
  return std::make_unique<SocketHub>(size, folder, false, watch);
}
std::unique_ptr<Hub> make_tcp_hub(const StarSize& size, const std::string& folder, const Watch& watch) {
  return std::make_unique<SocketHub>(size, folder, true, watch);
}
std::unique_ptr<Peer> connect_unix(const StarSize& size, int peer, const std::string& address, const Watch& watch) {
  return std::make_unique<SocketPeer>(size, peer, address, false, watch);
}
std::unique_ptr<Peer> connect_tcp(const StarSize& size, int peer, const std::string& address, const Watch& watch) {
  return std::make_unique<SocketPeer>(size, peer, address, true, watch);
}

}  // namespace interply::bench
