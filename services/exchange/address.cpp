#include "exchange/address.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstddef>
#include <cstring>
#include <memory>
#include <system_error>

#include "exchange/descriptor.hpp"
#include "process/words.hpp"

namespace interply::exchange {

namespace {

constexpr int kBacklog = 100;
constexpr std::size_t kLongestPath = sizeof(sockaddr_un::sun_path) - 1;

[[noreturn]] void refuse(const std::string& address, const std::string& why) {
  throw BadAddress(fmt::format("address '{}' {}", process::to_line(address), why));
}

std::string describe_error(int error) { return std::generic_category().message(error); }

std::string to_text(const Address& a) {
  switch (a.scheme) {
    case Address::Scheme::Memory:
      return "shm://" + a.path;
    case Address::Scheme::Unix:
      return "ipc://" + a.path;
    case Address::Scheme::Internet:
      break;
  }
  const bool is_ipv6 = a.host.find(':') != std::string::npos;
  return is_ipv6 ? fmt::format("tcp://[{}]:{}", a.host, a.port) : fmt::format("tcp://{}:{}", a.host, a.port);
}

int parse_port(const std::string& address, const std::string& text, AddressUse use) {
  const bool may_be_any = use == AddressUse::Listen;
  if (text == "*" && may_be_any) return 0;
  int port = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), port);
  if (text.empty() || error != std::errc() || end != text.data() + text.size() || port < (may_be_any ? 0 : 1) ||
      port > 65535)
    refuse(address, fmt::format("has the port '{}', which is not in [{}, 65535]{}", process::to_line(text),
                                may_be_any ? 0 : 1, may_be_any ? "; 0 takes a free one" : ""));
  return port;
}

Address parse_internet(const std::string& text, AddressUse use) {
  const std::string rest = text.substr(6);
  const std::size_t colon = rest.rfind(':');
  if (colon == std::string::npos) refuse(text, "has no port; give tcp://HOST:PORT");
  Address a{.scheme = Address::Scheme::Internet, .host = rest.substr(0, colon)};
  if (a.host.starts_with('[') && a.host.ends_with(']'))
    a.host = a.host.substr(1, a.host.size() - 2);
  else if (a.host.find(':') != std::string::npos)
    refuse(text, "has an IPv6 host without brackets; give tcp://[HOST]:PORT");
  const bool is_everywhere = a.host == "*" && use == AddressUse::Connect;
  if (a.host.empty() || a.host.find_first_of("/;@[] ") != std::string::npos || is_everywhere)
    refuse(text, "has no host; give tcp://HOST:PORT");
  a.port = parse_port(text, rest.substr(colon + 1), use);
  return a;
}

/// Of a name, the first IPv4 address, else the first IPv6 address.
struct Resolved {
  sockaddr_storage name{};
  socklen_t length = 0;
};

Resolved resolve(const Address& a) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;
  const bool any = a.host == "*";
  if (any) hints.ai_family = AF_INET;
  hints.ai_flags = AI_NUMERICSERV | (any ? AI_PASSIVE : 0);
  addrinfo* found = nullptr;
  const int rc = ::getaddrinfo(any ? nullptr : a.host.c_str(), std::to_string(a.port).c_str(), &hints, &found);
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> owner(found, &::freeaddrinfo);
  if (rc != 0)
    refuse(to_text(a), fmt::format("has a host that is not known here ({}); give its number", ::gai_strerror(rc)));
  const addrinfo* chosen = found;
  for (const addrinfo* i = found; i != nullptr && chosen->ai_family != AF_INET; i = i->ai_next)
    if (i->ai_family == AF_INET) chosen = i;
  Resolved r;
  r.length = chosen->ai_addrlen;
  std::memcpy(&r.name, chosen->ai_addr, chosen->ai_addrlen);
  return r;
}

struct UnixName {
  explicit UnixName(const std::string& path) {
    name.sun_family = AF_UNIX;
    std::memcpy(name.sun_path, path.data(), path.size());
    const bool is_file = !path.starts_with('@');
    if (!is_file) name.sun_path[0] = '\0';
    length = static_cast<socklen_t>(offsetof(sockaddr_un, sun_path) + path.size() + (is_file ? 1 : 0));
  }
  const sockaddr* get() const { return reinterpret_cast<const sockaddr*>(&name); }
  sockaddr_un name{};
  socklen_t length = 0;
};

[[noreturn]] void refuse_occupied(const Address& a) {
  throw std::runtime_error(fmt::format("cannot listen at {}: somebody else does; give another address", to_text(a)));
}

/// True if a dead socket lies at the path; nothing there is false. @throws as UnixListener
bool has_dead_socket(const Address& a) {
  struct stat found {};
  if (::lstat(a.path.c_str(), &found) != 0) {
    if (errno == ENOENT) return false;
    refuse(to_text(a), fmt::format("cannot be used: {}", describe_error(errno)));
  }
  if (!S_ISSOCK(found.st_mode))
    refuse(to_text(a), "names something that is not a socket, and that stays; give a path where nothing is");
  const Descriptor probe(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  const UnixName name(a.path);
  if (::connect(probe.number(), name.get(), name.length) != 0 && errno == ECONNREFUSED) return true;
  refuse_occupied(a);
}

}  // namespace

Address parse_address(const std::string& text, AddressUse use) {
  if (text.starts_with("tcp://")) return parse_internet(text, use);
  const bool memory = text.starts_with("shm://");
  if (!memory && !text.starts_with("ipc://")) refuse(text, "is not shm://PATH, ipc://PATH or tcp://HOST:PORT");
  Address a{.scheme = memory ? Address::Scheme::Memory : Address::Scheme::Unix, .path = text.substr(6)};
  const std::string_view path = a.path;
  if (path.empty() || path == "@" || path == "*") refuse(text, "has no path");
  if (path.find('\0') != path.npos) refuse(text, "has a path with a zero in it");
  if (path.size() > kLongestPath)
    refuse(text, fmt::format("has a path of {} bytes; a socket's path has at most {}", path.size(), kLongestPath));
  return a;
}

std::string to_endpoint(const Address& a) {
  if (a.scheme != Address::Scheme::Internet) return "ipc://" + a.path;
  const Resolved at = resolve(a);
  char host[NI_MAXHOST] = {};
  if (::getnameinfo(reinterpret_cast<const sockaddr*>(&at.name), at.length, host, sizeof(host), nullptr, 0,
                    NI_NUMERICHOST) != 0)
    refuse(to_text(a), "has a host that is not known here");
  return to_text({.scheme = Address::Scheme::Internet, .host = host, .port = a.port});
}

std::string find_missing_socket(const std::string& address) {
  const Address parsed = parse_address(address, AddressUse::Connect);
  const bool is_file = parsed.scheme != Address::Scheme::Internet && !parsed.path.starts_with('@');
  return is_file && ::access(parsed.path.c_str(), F_OK) != 0 ? parsed.path : "";
}

void check_listening(const std::string& text) {
  const Address a = parse_address(text, AddressUse::Listen);
  if (a.scheme != Address::Scheme::Internet) {
    const UnixListener listener(a);
    return;
  }
  const Resolved at = resolve(a);
  const Descriptor socket(::socket(at.name.ss_family, SOCK_STREAM | SOCK_CLOEXEC, 0));
  const int one = 1;
  ::setsockopt(socket.number(), SOL_SOCKET, SO_REUSEADDR, &one, sizeof(one));
  if (at.name.ss_family == AF_INET6) ::setsockopt(socket.number(), IPPROTO_IPV6, IPV6_V6ONLY, &one, sizeof(one));
  if (socket.number() >= 0 && ::bind(socket.number(), reinterpret_cast<const sockaddr*>(&at.name), at.length) == 0 &&
      ::listen(socket.number(), 1) == 0)
    return;
  if (errno == EADDRINUSE) refuse_occupied(a);
  refuse(text,
         fmt::format("is none that this host can listen at ({}); give one of its own addresses, such as 127.0.0.1",
                     describe_error(errno)));
}

UnixListener::UnixListener(const Address& a) {
  const bool is_file = !a.path.starts_with('@');
  if (is_file && has_dead_socket(a)) ::unlink(a.path.c_str());
  Descriptor socket(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0));
  const UnixName name(a.path);
  if (socket.number() < 0 || ::fchmod(socket.number(), 0600) != 0 ||
      ::bind(socket.number(), name.get(), name.length) != 0) {
    if (errno == EADDRINUSE) refuse_occupied(a);
    refuse(to_text(a),
           fmt::format("cannot be listened at: {}; give a path in a folder that you may write", describe_error(errno)));
  }
  struct stat bound {};
  if (is_file && ::lstat(a.path.c_str(), &bound) == 0) {
    path_ = a.path;
    device_ = bound.st_dev;
    file_ = bound.st_ino;
  }
  if (::listen(socket.number(), kBacklog) != 0)
    throw std::runtime_error(fmt::format("cannot listen at {}: {}", to_text(a), describe_error(errno)));
  descriptor_ = ::fcntl(socket.number(), F_DUPFD_CLOEXEC, 0);
}

UnixListener::~UnixListener() {
  if (descriptor_ >= 0) ::close(descriptor_);
  struct stat found {};
  if (!path_.empty() && ::lstat(path_.c_str(), &found) == 0 && found.st_dev == device_ && found.st_ino == file_)
    ::unlink(path_.c_str());
}

}  // namespace interply::exchange
