#include "exchange/zeromq_socket.hpp"

#include <fmt/format.h>
#include <malloc.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <zmq.hpp>

#include "exchange/address.hpp"

namespace interply::exchange {

namespace {

constexpr int kLinger = 1000;            ///< ms that a closed socket still tries to deliver what it sent
constexpr int kSendTimeout = 5000;       ///< ms until a full queue counts as a loss
constexpr int kHeartbeat = 1000;        ///< ms between signs of life
constexpr double kLongestSilence = 1e6;  ///< s; longer ones never end
constexpr int kReconnect = 20;           ///< ms between attempts while nobody listens yet
constexpr int kQueue = 100;              ///< messages per connection; lock-step needs two
constexpr int kKernelBuffer = 4 << 20;   ///< bytes; a whole message fits
constexpr int kKeptMemory = 1 << 29;     ///< bytes that stay with the process when they are free
constexpr int kLargestKept = 32 << 20;   ///< of these in one piece
constexpr std::chrono::milliseconds kListen{250};  ///< between two looks for silence
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

}  // namespace

bool is_shared_memory(const std::string& address) { return address.starts_with("shm://"); }
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
  ~Parts() { zmq_socket_monitor(socket.handle(), nullptr, 0); }

  zmq::context_t context;
  zmq::socket_t socket;
  zmq::socket_t news;
  const bool is_router;
  int socket_descriptor = -1, news_descriptor = -1;  ///< readable once when something happens
  zmq::message_t identity, frame, part;
  bool whole = true;
  bool shares_memory = false;
  std::optional<UnixListener> listener;  ///< whose descriptor ZeroMQ has
  Deadline::Clock::duration silence = Deadline::Clock::duration::max();
  Deadline::Clock::time_point listened{}, listens_since{};
};

ZeromqSocket::ZeromqSocket(Type type) : parts_(std::make_unique<Parts>(type)) {}
ZeromqSocket::~ZeromqSocket() = default;

void ZeromqSocket::limit_messages(std::int64_t bytes) { parts_->socket.set(zmq::sockopt::maxmsgsize, bytes); }

void ZeromqSocket::set_queue(int messages) { parts_->socket.set(zmq::sockopt::sndhwm, messages); }

void ZeromqSocket::limit_silence(double seconds) {
  if (seconds > kLongestSilence) return;
  const int wait = std::max(100, static_cast<int>(1000 * seconds));
  parts_->silence = std::chrono::milliseconds(wait);
  parts_->socket.set(zmq::sockopt::heartbeat_ivl, std::min(kHeartbeat, wait / 2));
  parts_->socket.set(zmq::sockopt::heartbeat_timeout, 0);  // would count the time in which we were stopped ourselves
}

int ZeromqSocket::find_silent(std::span<const int> connections) {
  Parts& p = *parts_;
  const auto now = Deadline::Clock::now();
  if (p.silence == Deadline::Clock::duration::max() || now - p.listened < kListen) return -1;
  if (now - p.listened > 2 * Deadline::kLook) p.listens_since = now;
  p.listened = now;
  if (now - p.listens_since < p.silence) return -1;
  for (const int connection : connections) {
    tcp_info info{};
    socklen_t size = sizeof(info);
    if (connection >= 0 && ::getsockopt(connection, IPPROTO_TCP, TCP_INFO, &info, &size) == 0 &&
        std::chrono::milliseconds(info.tcpi_last_data_recv) > p.silence)
      return connection;
  }
  return -1;
}

void ZeromqSocket::connect(const std::string& address) {
  const std::string endpoint = to_endpoint(parse_address(address, AddressUse::Connect));
  parts_->socket.set(zmq::sockopt::ipv6, endpoint.starts_with("tcp://["));
  if (zmq_connect(parts_->socket.handle(), endpoint.c_str()) != 0)
    throw BadAddress(fmt::format("cannot connect to {}: {}; give shm://PATH, ipc://PATH or tcp://HOST:PORT", address,
                                 zmq_strerror(errno)));
}

void ZeromqSocket::bind(const std::string& text) {
  const Address address = parse_address(text, AddressUse::Listen);
  const std::string endpoint = to_endpoint(address);
  parts_->shares_memory = address.scheme == Address::Scheme::Memory;
  if (address.scheme == Address::Scheme::Internet) {
    parts_->socket.set(zmq::sockopt::ipv6, endpoint.starts_with("tcp://["));
  } else {  // ZeroMQ would take away what lies there
    const int descriptor = parts_->listener.emplace(address).release();
    zmq_setsockopt(parts_->socket.handle(), ZMQ_USE_FD, &descriptor, sizeof(descriptor));
    const uid_t user = ::geteuid();  // a name has no permissions
    if (address.path.starts_with('@')) zmq_setsockopt(parts_->socket.handle(), ZMQ_IPC_FILTER_UID, &user, sizeof(user));
  }
  if (zmq_bind(parts_->socket.handle(), endpoint.c_str()) == 0) return;
  const std::string why = fmt::format("cannot listen at {}: {}", text, zmq_strerror(errno));
  if (errno == EADDRINUSE) throw std::runtime_error(why + "; give another address, or port 0 for a free one");
  throw BadAddress(why + "; give an address of this host");
}

std::string ZeromqSocket::endpoint() const {
  const std::string own = parts_->socket.get(zmq::sockopt::last_endpoint);
  return parts_->shares_memory ? "shm" + own.substr(3) : own;
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
  ::poll(items.data(), n, static_cast<int>(until.left().count()));
}

}  // namespace interply::exchange
