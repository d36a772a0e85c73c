#include "exchange/zeromq_socket.hpp"

#include <fmt/format.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

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

bool take(zmq::socket_t& socket, zmq::message_t& part) {
  return retry([&] { return zmq_msg_recv(part.handle(), socket.handle(), ZMQ_DONTWAIT); });
}

constexpr std::string_view kIpc = "ipc://";

/// ZeroMQ would take the path of a living coordinator away from it.
void check_unused(const std::string& address) {
  sockaddr_un name{};
  if (!address.starts_with(kIpc) || address.size() - kIpc.size() >= sizeof(name.sun_path)) return;
  name.sun_family = AF_UNIX;
  std::memcpy(name.sun_path, address.data() + kIpc.size(), address.size() - kIpc.size());
  const int probe = ::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  const bool answered = ::connect(probe, reinterpret_cast<const sockaddr*>(&name), sizeof(name)) == 0;
  ::close(probe);
  if (answered) throw std::runtime_error(fmt::format("cannot bind {}: another coordinator listens there", address));
}

}  // namespace

struct ZeromqSocket::Parts {
  explicit Parts(Type type)
      : socket(context, type == Type::Dealer ? zmq::socket_type::dealer : zmq::socket_type::router),
        news(context, zmq::socket_type::pair),
        is_router(type == Type::Router) {
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
  }
  ~Parts() {
    zmq_socket_monitor(socket.handle(), nullptr, 0);
    if (!ipc_path.empty()) ::unlink(ipc_path.c_str());  // ZeroMQ leaves it behind
  }

  zmq::context_t context;
  zmq::socket_t socket;
  zmq::socket_t news;
  const bool is_router;
  zmq::message_t identity, frame, part;
  bool whole = true;
  std::string ipc_path;  ///< that we listen at
};

ZeromqSocket::ZeromqSocket(Type type) : parts_(std::make_unique<Parts>(type)) {}
ZeromqSocket::~ZeromqSocket() = default;

void ZeromqSocket::limit_messages(std::int64_t bytes) { parts_->socket.set(zmq::sockopt::maxmsgsize, bytes); }

void ZeromqSocket::connect(const std::string& address) {
  if (zmq_connect(parts_->socket.handle(), address.c_str()) != 0)
    throw std::runtime_error(
        fmt::format("cannot connect to {}: {}; give ipc://path or tcp://host:port", address, zmq_strerror(errno)));
}

void ZeromqSocket::bind(const std::string& address) {
  check_unused(address);
  if (zmq_bind(parts_->socket.handle(), address.c_str()) != 0)
    throw std::runtime_error(
        fmt::format("cannot bind {}: {}; give ipc://path or tcp://address:port, port * for a "
                    "free one",
                    address, zmq_strerror(errno)));
  if (address.starts_with(kIpc)) parts_->ipc_path = address.substr(kIpc.size());
}

std::string ZeromqSocket::endpoint() const { return parts_->socket.get(zmq::sockopt::last_endpoint); }

bool ZeromqSocket::send(Bytes frame) {
  return retry([&] { return zmq_send(parts_->socket.handle(), frame.data(), frame.size(), 0); });
}

bool ZeromqSocket::send(std::string_view identity, Bytes frame) {
  void* const socket = parts_->socket.handle();
  constexpr int kFirst = ZMQ_SNDMORE | ZMQ_DONTWAIT;
  return retry([&] { return zmq_send(socket, identity.data(), identity.size(), kFirst); }) &&
         retry([&] { return zmq_send(socket, frame.data(), frame.size(), ZMQ_DONTWAIT); });
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

void ZeromqSocket::wait(const Deadline& until, int descriptor) {
  zmq_pollitem_t items[] = {{parts_->socket.handle(), 0, ZMQ_POLLIN, 0},
                            {parts_->news.handle(), 0, ZMQ_POLLIN, 0},
                            {nullptr, descriptor, ZMQ_POLLIN, 0}};
  zmq_poll(items, descriptor < 0 ? 2 : 3, static_cast<long>(until.left().count()));  // callers look again anyway
}

}  // namespace interply::exchange
