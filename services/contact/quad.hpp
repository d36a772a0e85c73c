/// A 3-vector of one node or triangle as a record of four doubles, for what is read and added by number: one load, one
/// addition.
#pragma once

namespace interply::contact {

struct alignas(32) Quad {
  double x = 0, y = 0, z = 0, w = 0;
};

namespace {  // these are compiled for different machines in kernel sources (simd/target.hpp)

using Four = double __attribute__((vector_size(32), may_alias));

inline Four load(const Quad& q) { return *reinterpret_cast<const Four*>(&q); }
inline void store(Quad& q, Four a) { *reinterpret_cast<Four*>(&q) = a; }
inline void add_to(Quad& q, Four a) { store(q, load(q) + a); }
inline Four load_four(const double* row) {
  Four a;
  __builtin_memcpy(&a, row, sizeof a);
  return a;
}
inline void store_four(double* row, Four a) { __builtin_memcpy(row, &a, sizeof a); }

inline Four turn_axes(Four a) { return __builtin_shufflevector(a, a, 1, 2, 0, 3); }
inline Four cross(Four a, Four b) { return turn_axes(a * turn_axes(b) - turn_axes(a) * b); }

/// Rows to columns: four records of (x, y, z, u), or back.
inline void transpose(Four& x, Four& y, Four& z, Four& u) {
  const Four xy0 = __builtin_shufflevector(x, y, 0, 4, 2, 6), xy1 = __builtin_shufflevector(x, y, 1, 5, 3, 7);
  const Four zu0 = __builtin_shufflevector(z, u, 0, 4, 2, 6), zu1 = __builtin_shufflevector(z, u, 1, 5, 3, 7);
  x = __builtin_shufflevector(xy0, zu0, 0, 1, 4, 5);
  y = __builtin_shufflevector(xy1, zu1, 0, 1, 4, 5);
  z = __builtin_shufflevector(xy0, zu0, 2, 3, 6, 7);
  u = __builtin_shufflevector(xy1, zu1, 2, 3, 6, 7);
}

}  // namespace
}  // namespace interply::contact
