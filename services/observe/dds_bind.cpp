#include "observe/dds_bind.hpp"

#include <arpa/inet.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace interply::observe {
namespace {

thread_local in_addr bind_address{INADDR_ANY};

int get_option(int socket, int option) {
  int value = 0;
  socklen_t size = sizeof value;
  getsockopt(socket, SOL_SOCKET, option, &value, &size);
  return value;
}

/// A UDP socket that nobody shares the port with: those for multicast are shared.
bool is_unicast(int socket) {
  return get_option(socket, SO_TYPE) == SOCK_DGRAM && get_option(socket, SO_REUSEADDR) == 0;
}

}  // namespace

BindTo::BindTo(const std::string& address) { inet_pton(AF_INET, address.c_str(), &bind_address); }
BindTo::~BindTo() { bind_address.s_addr = INADDR_ANY; }

}  // namespace interply::observe

extern "C" int bind(int socket, const sockaddr* address, socklen_t size) noexcept {
  using interply::observe::bind_address;
  sockaddr_in narrow{};
  if (bind_address.s_addr != INADDR_ANY && address->sa_family == AF_INET && interply::observe::is_unicast(socket)) {
    narrow = *reinterpret_cast<const sockaddr_in*>(address);
    if (narrow.sin_addr.s_addr == INADDR_ANY) {
      narrow.sin_addr = bind_address;
      address = reinterpret_cast<const sockaddr*>(&narrow);
    }
  }
  return static_cast<int>(syscall(SYS_bind, socket, address, size));
}
