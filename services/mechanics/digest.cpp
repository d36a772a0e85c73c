#include "mechanics/digest.hpp"

#include <xxhash.h>

#include <cstdio>

namespace interply::mechanics {

Digest::Digest() : state_(XXH3_createState()) { XXH3_64bits_reset(static_cast<XXH3_state_t*>(state_)); }

Digest::~Digest() { XXH3_freeState(static_cast<XXH3_state_t*>(state_)); }

void Digest::add(const void* data, std::size_t bytes) {
  XXH3_64bits_update(static_cast<XXH3_state_t*>(state_), data, bytes);
}

std::uint64_t Digest::value() const { return XXH3_64bits_digest(static_cast<XXH3_state_t*>(state_)); }

std::string to_hex(std::uint64_t digest) {
  char text[17];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(digest));
  return text;
}

}  // namespace interply::mechanics
