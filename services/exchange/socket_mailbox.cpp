#include <fmt/format.h>
#include <netinet/in.h>
#include <spdlog/spdlog.h>
#include <sys/socket.h>

#include <cerrno>
#include <system_error>
#include <utility>

#include "exchange/socket_mail.hpp"

namespace interply::exchange {

namespace {

constexpr double kPatience = 10;  ///< s for connecting, and for an answer to the hello
constexpr double kRoom = 1;       ///< s to wait until the kernel takes a whole motion

[[noreturn]] void fail(const char* what) { throw std::system_error(errno, std::generic_category(), what); }

/// Begins to connect to another port of the host at the other end of `connection`.
Descriptor connect_beside(int connection, int port) {
  sockaddr_storage name{};
  socklen_t length = sizeof(name);
  auto* at = reinterpret_cast<sockaddr*>(&name);
  if (::getpeername(connection, at, &length) != 0) fail("getpeername");
  auto& place = name.ss_family == AF_INET6 ? reinterpret_cast<sockaddr_in6&>(name).sin6_port
                                           : reinterpret_cast<sockaddr_in&>(name).sin_port;
  place = htons(static_cast<std::uint16_t>(port));
  Descriptor socket(::socket(name.ss_family, SOCK_STREAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0));
  if (socket.number() < 0) fail("socket");
  if (::connect(socket.number(), at, length) != 0 && errno != EINPROGRESS) fail("connect");
  return socket;
}

}  // namespace

SocketMailbox::SocketMailbox(int connection, const SocketOffer& offer)
    : n_nodes_(offer.n_nodes),
      hello_{.token = offer.token},
      patience_(kPatience),
      stream_(connect_beside(connection, offer.port)) {
  force_.resize(3, n_nodes_);
  look();
}

void SocketMailbox::look() {
  if (stage_ == Stage::Connecting) connect_on();
  if (stage_ == Stage::Greeting) greet_on();
  if (stage_ == Stage::Ready && posted_ && !arrived_) receive();
}

void SocketMailbox::connect_on() {
  pollfd connected{stream_->descriptor(), POLLOUT, 0};
  if (::poll(&connected, 1, 0) == 0) {
    if (patience_.passed()) give_up(fmt::format("no answer for {:g} s", kPatience));
    return;
  }
  int error = 0;
  socklen_t length = sizeof(error);
  ::getsockopt(stream_->descriptor(), SOL_SOCKET, SO_ERROR, &error, &length);
  if (error != 0) return give_up(std::generic_category().message(error));
  const std::array parts{make_part(&hello_, 1)};
  if (!stream_->send(parts)) return give_up("it hung up");
  stage_ = Stage::Greeting;
  patience_ = Deadline(kPatience);
}

void SocketMailbox::greet_on() {
  const std::array parts{make_part(&magic_, 1)};
  if (stream_->receive(parts, filled_) < 0) return give_up("it hung up");
  if (filled_ == sizeof(magic_)) {
    if (magic_ != kMailMagic) return give_up("something else answers there");
    stage_ = Stage::Ready;
  } else if (patience_.passed()) {
    give_up(fmt::format("no answer for {:g} s", kPatience));
  }
}

void SocketMailbox::receive() {
  if (stream_->is_sending() && !stream_->flush()) return cut();
  const std::array parts{make_part(&header_, 1), make_part(force_.data(), static_cast<std::size_t>(force_.size()))};
  if (stream_->receive(parts, filled_) < 0) return cut();
  if (filled_ < sizeof(ForceHeader)) return;
  if (header_.n_nodes != n_nodes_) return cut();
  arrived_ = filled_ == sizeof(ForceHeader) + sizeof(double) * static_cast<std::size_t>(force_.size());
}

void SocketMailbox::give_up(const std::string& why) {
  spdlog::warn("the coordinator's port for arrays cannot be used ({}): positions and forces travel as messages", why);
  stream_.reset();
  stage_ = Stage::Unused;
}

void SocketMailbox::cut() {
  stream_.reset();
  stage_ = Stage::Cut;
}

bool SocketMailbox::post(const Motion& motion) {
  look();
  const Eigen::Index n_thickness = motion.thickness.size();
  if (stage_ != Stage::Ready || posted_ || motion.position.cols() != n_nodes_ ||
      (n_thickness != 0 && n_thickness != n_nodes_))
    return false;
  const MotionHeader header{.n_nodes = n_nodes_, .mail = make_mail(motion)};
  const std::array parts{make_part(&header, 1),
                         make_part(motion.position.data(), static_cast<std::size_t>(motion.position.size())),
                         make_part(motion.thickness.data(), static_cast<std::size_t>(n_thickness))};
  posted_ = true;
  filled_ = 0;
  if (!stream_->send(parts)) cut();
  push();
  return true;
}

void SocketMailbox::push() {
  Deadline until(kRoom);
  while (stream_ && stream_->is_sending() && !until.passed()) {
    pollfd room{stream_->descriptor(), POLLOUT, 0};
    ::poll(&room, 1, static_cast<int>(until.left().count()));
    if (!stream_->flush()) cut();
  }
}

bool SocketMailbox::has_mail() {
  look();
  return arrived_;
}

std::int64_t SocketMailbox::read(Force& force) {
  posted_ = arrived_ = false;
  exchange::read(header_.mail, force);
  force.force.swap(force_);
  force_.resize(3, n_nodes_);
  return header_.mail.step;
}

pollfd SocketMailbox::announce_sleep() {
  switch (stage_) {
    case Stage::Connecting:
      return {stream_->descriptor(), POLLOUT, 0};
    case Stage::Greeting:
      return {stream_->descriptor(), POLLIN, 0};
    case Stage::Ready:
      if (posted_)
        return {stream_->descriptor(), static_cast<short>(stream_->is_sending() ? POLLIN | POLLOUT : POLLIN), 0};
      [[fallthrough]];
    default:
      return {-1, 0, 0};  // which poll ignores
  }
}

}  // namespace interply::exchange
