#include "exchange/stream.hpp"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>

namespace interply::exchange {

namespace {

constexpr std::size_t kParts = 4;

/// The parts without their first `done` bytes.
struct Rest {
  Rest(std::span<const iovec> parts, std::size_t done) {
    for (const iovec& part : parts) {
      const std::size_t skipped = std::min(done, part.iov_len);
      done -= skipped;
      if (part.iov_len > skipped)
        left[n++] = {static_cast<std::byte*>(part.iov_base) + skipped, part.iov_len - skipped};
    }
  }
  std::array<iovec, kParts> left;
  std::size_t n = 0;
};

bool may_go_on() { return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR; }

}  // namespace

Stream::Stream(Descriptor socket) : socket_(std::move(socket)) {
  const int one = 1;
  ::setsockopt(descriptor(), IPPROTO_TCP, TCP_NODELAY, &one, sizeof(one));
}

bool Stream::send(std::span<const iovec> parts) {
  Rest all(parts, 0);
  msghdr message{};
  message.msg_iov = all.left.data();
  message.msg_iovlen = all.n;
  const ssize_t taken = ::sendmsg(descriptor(), &message, MSG_NOSIGNAL | MSG_DONTWAIT);
  if (taken < 0 && !may_go_on()) return false;
  const Rest rest(parts, taken > 0 ? static_cast<std::size_t>(taken) : 0);
  kept_.clear();
  sent_ = 0;
  for (std::size_t i = 0; i < rest.n; ++i) {
    const auto* begin = static_cast<const std::byte*>(rest.left[i].iov_base);
    kept_.insert(kept_.end(), begin, begin + rest.left[i].iov_len);
  }
  return true;
}

bool Stream::flush() {
  while (is_sending()) {
    const ssize_t taken = ::send(descriptor(), kept_.data() + sent_, kept_.size() - sent_, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (taken < 0) return may_go_on();
    sent_ += static_cast<std::size_t>(taken);
  }
  return true;
}

ssize_t Stream::receive(std::span<const iovec> parts, std::size_t& filled) {
  Rest rest(parts, filled);
  if (rest.n == 0) return 0;
  const ssize_t got = ::readv(descriptor(), rest.left.data(), static_cast<int>(rest.n));
  if (got > 0) filled += static_cast<std::size_t>(got);
  if (got < 0) return may_go_on() ? 0 : -1;
  return got > 0 ? got : -1;
}

}  // namespace interply::exchange
