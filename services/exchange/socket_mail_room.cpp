#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <spdlog/spdlog.h>
#include <sys/epoll.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <memory>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "exchange/socket_mail.hpp"

namespace interply::exchange {

namespace {

// Names of descriptors in epoll: seats have their number.
constexpr std::uint64_t kListener = UINT64_C(1) << 62;
constexpr std::uint64_t kStranger = UINT64_C(1) << 61;  ///< and the slot
constexpr int kBacklog = 64;
constexpr const char* kEnded = "the socket for its arrays has ended";

[[noreturn]] void fail(const std::string& what) { throw std::system_error(errno, std::generic_category(), what); }

using Addresses = std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)>;

Addresses resolve(const std::string& host, int port) {
  addrinfo hints{};
  hints.ai_flags = AI_NUMERICHOST | AI_NUMERICSERV;
  hints.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  if (const int rc = ::getaddrinfo(host.c_str(), std::to_string(port).c_str(), &hints, &found); rc != 0)
    throw std::runtime_error(fmt::format("{}: {}", host, ::gai_strerror(rc)));
  return {found, &::freeaddrinfo};
}

Descriptor listen_at(const std::string& host, int port) {
  const Addresses at = resolve(host, port);
  Descriptor listener(::socket(at->ai_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (listener.number() < 0) fail("socket");
  const int one = 1;
  ::setsockopt(listener.number(), SOL_SOCKET, SO_REUSEADDR, &one, sizeof(one));
  if (::bind(listener.number(), at->ai_addr, at->ai_addrlen) != 0 || ::listen(listener.number(), kBacklog) != 0)
    fail(fmt::format("listen at {} port {}", host, port));
  return listener;
}

/// At the port after that of `endpoint`, else at any.
Descriptor listen_beside(const std::string& endpoint) {
  const std::size_t begin = endpoint.find("//") + 2, end = endpoint.rfind(':');
  std::string host = endpoint.substr(begin, end - begin);
  if (host.starts_with('[')) host = host.substr(1, host.size() - 2);
  const int next = std::stoi(endpoint.substr(end + 1)) + 1;
  try {
    if (next < 1 << 16) return listen_at(host, next);
  } catch (const std::system_error&) {
    // somebody else has it
  }
  return listen_at(host, 0);
}

int find_port(const Descriptor& listener) {
  sockaddr_storage name{};
  socklen_t length = sizeof(name);
  if (::getsockname(listener.number(), reinterpret_cast<sockaddr*>(&name), &length) != 0) fail("getsockname");
  return ntohs(name.ss_family == AF_INET6 ? reinterpret_cast<const sockaddr_in6&>(name).sin6_port
                                          : reinterpret_cast<const sockaddr_in&>(name).sin_port);
}

std::string describe_peer(int socket) {
  sockaddr_storage name{};
  socklen_t length = sizeof(name);
  char host[NI_MAXHOST] = "an unknown address";
  if (::getpeername(socket, reinterpret_cast<sockaddr*>(&name), &length) == 0)
    ::getnameinfo(reinterpret_cast<const sockaddr*>(&name), length, host, sizeof(host), nullptr, 0, NI_NUMERICHOST);
  return std::string("a stranger at ") + host;
}

}  // namespace

SocketMailRoom::SocketMailRoom(const std::string& endpoint, const std::vector<Expected>& expected)
    : listener_(listen_beside(endpoint)),
      epoll_(::epoll_create1(EPOLL_CLOEXEC)),
      port_(find_port(listener_)),
      seats_(expected.size()) {
  if (epoll_.number() < 0) fail("epoll_create1");
  for (std::size_t i = 0; i < expected.size(); ++i) {
    seats_[i].n_nodes = expected[i].n_nodes;
    seats_[i].token = make_token();
    seats_[i].position.resize(3, expected[i].n_nodes);
    seats_[i].thickness.resize(expected[i].n_nodes);
  }
  watch(listener_.number(), EPOLLIN, kListener, EPOLL_CTL_ADD);
}

MailOffer SocketMailRoom::offer(int who) const {
  return SocketOffer{.port = port_, .token = seat(who).token, .n_nodes = seat(who).n_nodes};
}

void SocketMailRoom::watch(int descriptor, std::uint32_t events, std::uint64_t name, int operation) const {
  epoll_event event{.events = events, .data = {.u64 = name}};
  if (::epoll_ctl(epoll_.number(), operation, descriptor, &event) != 0) fail("epoll_ctl");
}

void SocketMailRoom::look() {
  std::array<epoll_event, 64> events;
  const int n = ::epoll_wait(epoll_.number(), events.data(), static_cast<int>(events.size()), 0);
  for (int i = 0; i < n; ++i) {
    const epoll_event& event = events[static_cast<std::size_t>(i)];
    if (event.data.u64 == kListener)
      accept_strangers();
    else if (event.data.u64 >= kStranger)
      hear(event.data.u64 - kStranger);
    else
      serve(event.data.u64, event.events);
  }
}

void SocketMailRoom::accept_strangers() {
  for (std::size_t i = 0; i < strangers_.size(); ++i) {
    Descriptor socket(::accept4(listener_.number(), nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC));
    if (socket.number() < 0) {
      if (errno != EMFILE && errno != ENFILE && errno != ENOBUFS && errno != ENOMEM) return;
      // the listener would wake us again and again
      spdlog::warn("no more connections for arrays ({}): layers that are not connected yet send messages",
                   std::generic_category().message(errno));
      return watch(listener_.number(), 0, kListener, EPOLL_CTL_MOD);
    }
    const std::size_t slot = next_slot_++ % strangers_.size();
    strangers_[slot].reset();
    strangers_[slot].emplace(Stranger{Stream(std::move(socket)), {}});
    watch(strangers_[slot]->stream.descriptor(), EPOLLIN, kStranger + slot, EPOLL_CTL_ADD);
  }
}

void SocketMailRoom::hear(std::size_t slot) {
  if (!strangers_[slot]) return;
  Stranger& stranger = *strangers_[slot];
  const std::array parts{make_part(&stranger.hello, 1)};
  const ssize_t got = stranger.stream.receive(parts, stranger.filled);
  if (got >= 0 && stranger.filled < sizeof(Hello)) return;
  if (got > 0) {
    const auto found = std::find_if(seats_.begin(), seats_.end(), [&](const Seat& s) {
      return stranger.hello.magic == kMailMagic && stranger.hello.token == s.token && !s.stream && s.why_cut.empty();
    });
    if (found != seats_.end())
      admit(stranger, static_cast<std::size_t>(found - seats_.begin()));
    else
      refusals_.warn(describe_peer(stranger.stream.descriptor()), "token",
                     fmt::format("did not say the token of a layer at port {}", port_));
  }
  strangers_[slot].reset();
}

void SocketMailRoom::admit(Stranger& stranger, std::size_t who) {
  Seat& s = seats_[who];
  s.stream.emplace(std::move(stranger.stream));
  watch(s.stream->descriptor(), EPOLLIN, who, EPOLL_CTL_MOD);
  const std::array parts{make_part(&kMailMagic, 1)};
  if (!s.stream->send(parts)) s.stream.reset();
}

void SocketMailRoom::serve(std::size_t who, std::uint32_t events) {
  Seat& s = seats_[who];
  if (!s.stream) return;
  if (s.stream->is_sending()) {
    if (!s.stream->flush()) return cut(s, kEnded);
    if (!s.stream->is_sending()) watch(s.stream->descriptor(), EPOLLIN, who, EPOLL_CTL_MOD);
  }
  if ((events & ~EPOLLOUT) != 0) receive(s);
}

void SocketMailRoom::receive(Seat& s) {
  if (s.turn != Turn::Solver) {  // only the end can come
    char byte;
    std::size_t filled = 0;
    const std::array parts{make_part(&byte, 1)};
    const ssize_t got = s.stream->receive(parts, filled);
    if (got != 0) cut(s, got < 0 ? kEnded : "a motion came before the last one was answered");
    return;
  }
  const auto n = static_cast<std::size_t>(s.n_nodes);
  const std::array parts{make_part(&s.header, 1), make_part(s.position.data(), 3 * n),
                         make_part(s.thickness.data(), n)};
  if (s.stream->receive(parts, s.filled) < 0) return cut(s, kEnded);
  if (s.filled < sizeof(MotionHeader)) return;
  const std::int64_t n_thickness = s.header.mail.n_thickness;
  if (s.header.n_nodes != s.n_nodes || (n_thickness != 0 && n_thickness != s.n_nodes))
    return cut(s, fmt::format("a motion came of {} nodes and {} thicknesses, the scene gives it {} nodes",
                              s.header.n_nodes, n_thickness, s.n_nodes));
  const std::size_t whole = sizeof(MotionHeader) + sizeof(double) * (3 * n + static_cast<std::size_t>(n_thickness));
  if (s.filled > whole) return cut(s, "a motion was longer than it said");
  if (s.filled == whole) s.turn = Turn::Arrived;
}

void SocketMailRoom::cut(Seat& s, const std::string& why) {
  s.stream.reset();
  if (s.turn != Turn::Over) s.why_cut = why;
}

MotionMail SocketMailRoom::take(int who) {
  seat(who).turn = Turn::Coordinator;
  return seat(who).header.mail;
}

void SocketMailRoom::read(int who, const MotionMail& mail, Motion& motion) {
  Seat& s = seat(who);
  exchange::read(mail, motion);
  motion.position.swap(s.position);
  s.position.resize(3, s.n_nodes);
  motion.thickness = s.thickness.head(mail.n_thickness);
}

bool SocketMailRoom::answer(int who, const Force& force) {
  Seat& s = seat(who);
  if (!s.stream) return false;
  s.turn = force.last ? Turn::Over : Turn::Solver;
  s.filled = 0;
  const ForceHeader header{.n_nodes = s.n_nodes, .mail = make_mail(force)};
  const std::array parts{make_part(&header, 1),
                         make_part(force.force.data(), static_cast<std::size_t>(force.force.size()))};
  if (!s.stream->send(parts)) {
    s.turn = Turn::Solver;
    cut(s, kEnded);
    return false;
  }
  if (s.stream->is_sending())
    watch(s.stream->descriptor(), EPOLLIN | EPOLLOUT, static_cast<std::uint64_t>(who), EPOLL_CTL_MOD);
  return true;
}

}  // namespace interply::exchange
