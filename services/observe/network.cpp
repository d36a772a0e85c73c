#include "observe/network.hpp"

#include <arpa/inet.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <spdlog/fmt/fmt.h>

#include <memory>
#include <stdexcept>

#include "process/words.hpp"

namespace interply::observe {
namespace {

in_addr address_of(const sockaddr* a) { return reinterpret_cast<const sockaddr_in*>(a)->sin_addr; }

std::string to_text(in_addr address) {
  char text[INET_ADDRSTRLEN] = {};
  inet_ntop(AF_INET, &address, text, sizeof text);
  return text;
}

}  // namespace

Interface find_interface(const std::string& network) {
  ifaddrs* first = nullptr;
  if (getifaddrs(&first) != 0) throw std::runtime_error("the network interfaces of this host cannot be listed");
  const std::unique_ptr<ifaddrs, void (*)(ifaddrs*)> interfaces(first, freeifaddrs);
  in_addr wanted{};
  const bool is_address = inet_pton(AF_INET, network.c_str(), &wanted) == 1 && wanted.s_addr != INADDR_ANY;
  std::string known;
  for (const ifaddrs* i = first; i; i = i->ifa_next) {
    if (!i->ifa_addr || i->ifa_addr->sa_family != AF_INET || !(i->ifa_flags & IFF_UP)) continue;
    const in_addr address = address_of(i->ifa_addr);
    const in_addr_t mask = i->ifa_netmask ? address_of(i->ifa_netmask).s_addr : INADDR_NONE;
    const bool is_it = is_address && (wanted.s_addr == address.s_addr || wanted.s_addr == (address.s_addr & mask));
    if (network == i->ifa_name || is_it) return {i->ifa_name, to_text(address)};
    known += fmt::format("{}{} ({})", known.empty() ? "" : ", ", i->ifa_name, to_text(address));
  }
  throw std::runtime_error(
      fmt::format("observe.network: '{}' is no network interface of this host; give the name, IPv4 address or network "
                  "of one of {}",
                  process::to_line(network), known.empty() ? "none: all are down" : known));
}

}  // namespace interply::observe
