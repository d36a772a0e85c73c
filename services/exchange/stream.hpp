/// A TCP connection that never makes its owner wait. Internal to exchange.
#pragma once

#include <sys/types.h>
#include <sys/uio.h>

#include <cstddef>
#include <span>
#include <vector>

#include "exchange/descriptor.hpp"

namespace interply::exchange {

class Stream {
 public:
  /// @param socket  non-blocking
  explicit Stream(Descriptor socket);
  int descriptor() const { return socket_.number(); }

  /// Sends all parts in order, straight from where they lie. What the kernel does not take at once is copied and goes
  /// out by flush(). False: the connection has ended.   @pre is_sending() is false   @pre at most 4 parts
  bool send(std::span<const iovec> parts);
  bool flush();
  bool is_sending() const { return sent_ < kept_.size(); }

  /// Receives into the parts in order, `filled` bytes of which are there already, and adds to it.
  /// @returns what has come, 0: nothing more at present, -1: the connection has ended   @pre at most 4 parts
  ssize_t receive(std::span<const iovec> parts, std::size_t& filled);

 private:
  Descriptor socket_;
  std::vector<std::byte> kept_;  ///< the rest of a message; its memory is used again
  std::size_t sent_ = 0;         ///< of these, bytes
};

/// For parts of a message. Only receive() writes to them.
template <typename T>
iovec make_part(const T* data, std::size_t n) {
  return {const_cast<T*>(data), n * sizeof(T)};
}

}  // namespace interply::exchange
