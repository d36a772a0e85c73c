#include "exchange/zeromq_socket.hpp"

#include <fmt/format.h>
#include <malloc.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <zmq.hpp>

namespace interply::exchange {

namespace {

constexpr int kLinger = 1000;           ///< ms that a closed socket still tries to deliver what it sent
constexpr int kSendTimeout = 5000;      ///< ms until a full queue counts as a loss
constexpr int kReconnect = 20;          ///< ms between attempts while nobody listens yet
constexpr int kQueue = 100;             ///< messages per connection; lock-step needs two
constexpr int kKernelBuffer = 4 << 20;  ///< bytes; a whole message fits
constexpr int kKeptMemory = 1 << 29;    ///< bytes that stay with the process when they are free
constexpr int kLargestKept = 32 << 20;  ///< of these in one piece
constexpr const char* kNews = "inproc://news";

/// Calls again when a signal interrupted. False: errno says why.
template <typename Call>
bool retry(Call&& call) {
  int rc;
  do {
    rc = call();
  } while (rc < 0 && errno == EINTR);
  return rc >= 0;
}

/// ZeroMQ allocates each message anew. By default the C library hands pieces of this size back to the kernel and gets
/// them again, page by page, in every step: a third of the time of an exchange over sockets.
void keep_freed_memory() {
#ifdef __GLIBC__
  static const int kept = ::mallopt(M_TRIM_THRESHOLD, kKeptMemory) + ::mallopt(M_MMAP_THRESHOLD, kLargestKept);
  static_cast<void>(kept);
#endif
}

bool take(zmq::socket_t& socket, zmq::message_t& part) {
  return retry([&] { return zmq_msg_recv(part.handle(), socket.handle(), ZMQ_DONTWAIT); });
}

constexpr std::string_view kIpc = "ipc://";
constexpr std::string_view kShared = "shm://";

std::string to_zeromq(const std::string& address) {
  return is_shared_memory(address) ? std::string(kIpc) + address.substr(kShared.size()) : address;
}

/// A coordinator lives behind this path: ZeroMQ would take it away.
bool is_answered(const std::string& address) {
  sockaddr_un name{};
  if (!address.starts_with(kIpc) || address.size() - kIpc.size() >= sizeof(name.sun_path)) return false;
  name.sun_family = AF_UNIX;
  std::memcpy(name.sun_path, address.data() + kIpc.size(), address.size() - kIpc.size());
  const int probe = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const bool answered = ::connect(probe, reinterpret_cast<const sockaddr*>(&name), sizeof(name)) == 0;
  ::close(probe);
  return answered;
}

}  // namespace

bool is_shared_memory(const std::string& address) { return address.starts_with(kShared); }
bool is_tcp(const std::string& address) { return address.starts_with("tcp://"); }

struct ZeromqSocket::Parts {
  explicit Parts(Type type)
      : socket(context, type == Type::Dealer ? zmq::socket_type::dealer : zmq::socket_type::router),
        news(context, zmq::socket_type::pair),
        is_router(type == Type::Router) {
    keep_freed_memory();
    socket.set(zmq::sockopt::linger, kLinger);
    socket.set(zmq::sockopt::sndhwm, kQueue);
    socket.set(zmq::sockopt::rcvhwm, kQueue);
    socket.set(zmq::sockopt::sndbuf, kKernelBuffer);
    socket.set(zmq::sockopt::rcvbuf, kKernelBuffer);
    socket.set(zmq::sockopt::sndtimeo, kSendTimeout);
    socket.set(zmq::sockopt::reconnect_ivl, kReconnect);
    if (is_router) socket.set(zmq::sockopt::router_mandatory, true);
    const int events = ZMQ_EVENT_DISCONNECTED | (is_router ? 0 : ZMQ_EVENT_HANDSHAKE_SUCCEEDED);
    if (zmq_socket_monitor(socket.handle(), kNews, events) != 0) throw zmq::error_t();
    news.set(zmq::sockopt::rcvhwm, 0);  // a full queue would block the thread that moves the messages
    news.connect(kNews);
    socket_descriptor = socket.get(zmq::sockopt::fd);
    news_descriptor = news.get(zmq::sockopt::fd);
  }
  ~Parts() {
    zmq_socket_monitor(socket.handle(), nullptr, 0);
    if (!ipc_path.empty()) ::unlink(ipc_path.c_str());  // ZeroMQ leaves it behind
  }

  zmq::context_t context;
  zmq::socket_t socket;
  zmq::socket_t news;
  const bool is_router;
  int socket_descriptor = -1, news_descriptor = -1;  ///< readable once when something happens
  zmq::message_t identity, frame, part;
  bool whole = true;
  bool shares_memory = false;
  std::string ipc_path;  ///< that we listen at
};

ZeromqSocket::ZeromqSocket(Type type) : parts_(std::make_unique<Parts>(type)) {}
ZeromqSocket::~ZeromqSocket() = default;

void ZeromqSocket::limit_messages(std::int64_t bytes) { parts_->socket.set(zmq::sockopt::maxmsgsize, bytes); }

void ZeromqSocket::set_queue(int messages) { parts_->socket.set(zmq::sockopt::sndhwm, messages); }

void ZeromqSocket::connect(const std::string& address) {
  if (zmq_connect(parts_->socket.handle(), to_zeromq(address).c_str()) != 0)
    throw std::runtime_error(fmt::format("cannot connect to {}: {}; give shm://path, ipc://path or tcp://host:port",
                                         address, zmq_strerror(errno)));
}

void ZeromqSocket::bind(const std::string& address) {
  const std::string own = to_zeromq(address);
  if (is_answered(own))
    throw std::runtime_error(fmt::format("cannot bind {}: another coordinator listens there", address));
  if (zmq_bind(parts_->socket.handle(), own.c_str()) != 0)
    throw std::runtime_error(
        fmt::format("cannot bind {}: {}; give shm://path, ipc://path or tcp://address:port, port * for a free one",
                    address, zmq_strerror(errno)));
  parts_->shares_memory = is_shared_memory(address);
  if (own.starts_with(kIpc)) parts_->ipc_path = own.substr(kIpc.size());
}

std::string ZeromqSocket::endpoint() const {
  const std::string own = parts_->socket.get(zmq::sockopt::last_endpoint);
  return parts_->shares_memory ? std::string(kShared) + own.substr(kIpc.size()) : own;
}

bool ZeromqSocket::send(Bytes frame) {
  return retry([&] { return zmq_send(parts_->socket.handle(), frame.data(), frame.size(), 0); });
}

bool ZeromqSocket::send(std::string_view identity, Bytes frame) {
  void* const socket = parts_->socket.handle();
  constexpr int kFirst = ZMQ_SNDMORE | ZMQ_DONTWAIT;
  return retry([&] { return zmq_send(socket, identity.data(), identity.size(), kFirst); }) &&
         retry([&] { return zmq_send(socket, frame.data(), frame.size(), ZMQ_DONTWAIT); });
}

bool ZeromqSocket::relay(std::string_view identity) {
  void* const socket = parts_->socket.handle();
  return retry([&] { return zmq_send(socket, identity.data(), identity.size(), ZMQ_SNDMORE | ZMQ_DONTWAIT); }) &&
         retry([&] { return zmq_msg_send(parts_->frame.handle(), socket, ZMQ_DONTWAIT); });
}

bool ZeromqSocket::receive() {
  Parts& p = *parts_;
  if (p.is_router && !take(p.socket, p.identity)) return false;
  if (!take(p.socket, p.frame)) return false;
  p.whole = !p.frame.more();
  // parts of a message arrive together
  for (bool more = !p.whole; more && take(p.socket, p.part);) more = p.part.more();
  return true;
}

Bytes ZeromqSocket::frame() const {
  return {static_cast<const std::byte*>(parts_->frame.data()), parts_->frame.size()};
}

bool ZeromqSocket::is_whole() const { return parts_->whole; }
std::string_view ZeromqSocket::identity() const { return parts_->identity.to_string_view(); }
int ZeromqSocket::descriptor() const { return zmq_msg_get(parts_->frame.handle(), ZMQ_SRCFD); }

std::string ZeromqSocket::peer_address() const {
  const char* address = zmq_msg_gets(parts_->frame.handle(), "Peer-Address");
  return address ? address : "an unknown address";
}

std::optional<ZeromqSocket::News> ZeromqSocket::next_news() {
  std::uint16_t id;
  std::int32_t descriptor;
  zmq::message_t& part = parts_->part;
  if (!take(parts_->news, part) || part.size() < sizeof(id) + sizeof(descriptor)) return {};
  std::memcpy(&id, part.data(), sizeof(id));
  std::memcpy(&descriptor, static_cast<const char*>(part.data()) + sizeof(id), sizeof(descriptor));
  take(parts_->news, part);  // the endpoint
  return News{id != ZMQ_EVENT_DISCONNECTED, descriptor};
}

void ZeromqSocket::wait(const Deadline& until, std::initializer_list<pollfd> others) {
  std::array<pollfd, 4> items;
  std::size_t n = 0;
  for (const int own : {parts_->socket_descriptor, parts_->news_descriptor}) items[n++] = {own, POLLIN, 0};
  for (const pollfd& other : others) items[n++] = other;
  ::poll(items.data(), n, static_cast<int>(std::min<std::int64_t>(until.left().count(), 1 << 30)));
}

}  // namespace interply::exchange
