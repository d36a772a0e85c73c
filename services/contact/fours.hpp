/// Four nodes at a time: the records of nodes turned into vectors of their components, and back.
#pragma once

#include <cmath>
#include <cstddef>

#include "contact/quad.hpp"

namespace interply::contact {
namespace {

inline Four sqrt(Four a) { return Four{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])}; }

/// Body(i, count) for four nodes of [begin, end) at a time, the last ones alone.
template <class Body>
inline void for_each_four(std::ptrdiff_t begin, std::ptrdiff_t end, const Body& body) {
  std::ptrdiff_t i = begin;
  for (; i + 4 <= end; i += 4) body(i, 4);
  if (i < end) body(i, static_cast<int>(end - i));
}

/// A vector of four nodes, or of fewer and then the last one again.
struct Vectors {
  Four x, y, z, w;
};
template <class Get>
inline Vectors gather(std::ptrdiff_t i, int count, const Get& get) {
  const auto at = [&](int l) { return load(get(i + (l < count ? l : count - 1))); };
  Vectors v{at(0), at(1), at(2), at(3)};
  transpose(v.x, v.y, v.z, v.w);
  return v;
}
template <class Get>
inline void scatter(std::ptrdiff_t i, int count, Vectors v, const Get& get) {
  transpose(v.x, v.y, v.z, v.w);
  const Four rows[4] = {v.x, v.y, v.z, v.w};
  for (int l = 0; l < 4; ++l)
    if (l < count) store(get(i + l), rows[l]);
}
inline Four load_row(const double* row, std::ptrdiff_t i, int count) {
  if (count == 4) return load_four(row + i);
  Four a{};
  for (int l = 0; l < 4; ++l) a[l] = row[i + (l < count ? l : count - 1)];
  return a;
}
inline void store_row(double* row, std::ptrdiff_t i, int count, Four a) {
  if (count == 4) return store_four(row + i, a);
  for (int l = 0; l < count; ++l) row[i + l] = a[l];
}

}  // namespace
}  // namespace interply::contact
