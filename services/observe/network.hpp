/// Network interfaces of this host, as `observe.network` names them.
#pragma once

#include <string>

namespace interply::observe {

struct Interface {
  std::string name;     ///< e.g. "eth0"
  std::string address;  ///< IPv4, e.g. "10.0.0.2"
};

/// The interface that `network` means: its name, its IPv4 address, or the address of its network (10.0.0.0), which
/// finds the right interface on each of several hosts.
/// @throws std::runtime_error one sentence that lists the interfaces there are
Interface find_interface(const std::string& network);

}  // namespace interply::observe
