/// Digest of a state, equal only if every bit is equal.
#pragma once

#include <cstdint>
#include <string>

#include "mechanics/nodal.hpp"

namespace interply::mechanics {

/// XXH3, 64 bit, over the bytes of doubles in the order they are added.
class Digest {
 public:
  Digest();
  ~Digest();
  Digest(const Digest&) = delete;
  Digest& operator=(const Digest&) = delete;
  void add(const void* data, std::size_t bytes);
  template <typename Derived>
  void add(const Eigen::PlainObjectBase<Derived>& a) {
    add(a.data(), sizeof(typename Derived::Scalar) * static_cast<std::size_t>(a.size()));
  }
  std::uint64_t value() const;

 private:
  void* state_;
};

/// 16 hexadecimal digits.
std::string to_hex(std::uint64_t digest);

}  // namespace interply::mechanics
