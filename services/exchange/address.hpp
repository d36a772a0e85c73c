/// Addresses that a coordinator listens at and solvers connect to.
#pragma once

#include <stdexcept>
#include <string>
#include <utility>

namespace interply::exchange {

/// Text that is no address, or an address that cannot be used on this host: one sentence with the address and the cure.
class BadAddress : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// What an address says.
struct Address {
  enum class Scheme {
    Memory,   ///< shm://PATH: messages travel as over ipc
    Unix,     ///< ipc://PATH: a Unix socket
    Internet  ///< tcp://HOST:PORT
  };
  Scheme scheme = Scheme::Unix;
  std::string path;  ///< of the Unix socket; a name that begins with '@' is no file: only this user reaches it
  std::string host;  ///< name or number, IPv6 without its brackets; '*': every interface (to listen only)
  int port = 0;      ///< 0: any free one (to listen only)
};

/// Whether an address is to listen at or to connect to.
enum class AddressUse { Listen, Connect };

/// @param text  shm://PATH, ipc://PATH or tcp://HOST:PORT, an IPv6 host in brackets; port '*' or 0 takes a free one
/// @throws BadAddress
Address parse_address(const std::string& text, AddressUse use);

/// The address as ZeroMQ takes it, the host as a number. A name stands for its first IPv4 address, else for its first
/// IPv6 address, at both ends alike: localhost is 127.0.0.1.
/// @throws BadAddress if the host is unknown here
std::string to_endpoint(const Address& address);

/// The file of a Unix socket that is not there (yet), or nothing. @throws BadAddress
std::string find_missing_socket(const std::string& address);

/// Why a coordinator of this host cannot listen there. Nothing stays bound.
/// @throws BadAddress if it never could; std::runtime_error if somebody else does at present
void check_listening(const std::string& address);

/// A Unix socket that this process listens at, reached by this user only, and whose file is removed with this object.
class UnixListener {
 public:
  /// What lies at the path is replaced only if it is a socket that nobody listens at.
  /// @throws BadAddress, std::runtime_error if somebody listens there
  explicit UnixListener(const Address& address);
  ~UnixListener();
  UnixListener(const UnixListener&) = delete;
  UnixListener& operator=(const UnixListener&) = delete;
  /// The listening descriptor; whoever takes it closes it.
  int release() { return std::exchange(descriptor_, -1); }

 private:
  std::string path_;  ///< of our file; empty: none
  int descriptor_ = -1;
  unsigned long device_ = 0, file_ = 0;  ///< what we have bound, whatever lies at the path later
};

}  // namespace interply::exchange
