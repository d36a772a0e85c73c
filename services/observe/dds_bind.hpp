/// Which addresses of the host Cyclone DDS listens on. Internal to observe.
#pragma once

#include <netinet/in.h>

#include <string>

namespace interply::observe {

/// While one lives, the unicast sockets that this thread binds to every address of the host are bound to one alone.
///
/// Cyclone DDS 0.10 binds the sockets that it receives on to 0.0.0.0, whatever interface it is given, and has no
/// setting for it. So `bind` of this program stands before the C library's and replaces that address.
class BindTo {
 public:
  /// @param address  IPv4
  explicit BindTo(const std::string& address);
  ~BindTo();
  BindTo(const BindTo&) = delete;
  BindTo& operator=(const BindTo&) = delete;
};

}  // namespace interply::observe
