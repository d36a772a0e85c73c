/// Records of nodes (node.hpp) as packs of their components. For kernel sources only.
#pragma once

#include "contact/node.hpp"
#include "simd/pack.hpp"

namespace interply::contact {
namespace {

using simd::any;
using simd::dot;
using simd::fuse;
using simd::gather;
using simd::Index;
using simd::Mask;
using simd::max;
using simd::min;
using simd::read_lanes;
using simd::select;
using simd::sqrt;
using simd::write_lanes;
using Real = simd::Pack;
using Vec3 = simd::Vec3<Real>;
constexpr int kWidth = simd::kWidth<Real>;
using Indices = std::array<int, kWidth>;

/// a u + b v. Which of two products is rounded first the compiler may choose anew for each target and for packs that
/// are not full; where forces depend on it, this does.
inline Real combine(const Real& a, const Real& u, const Real& b, const Real& v) { return fuse(a, u, b * v); }
inline Vec3 combine(const Real& a, const Vec3& u, const Real& b, const Vec3& v) {
  return {combine(a, u.x, b, v.x), combine(a, u.y, b, v.y), combine(a, u.z, b, v.z)};
}

#if defined(INTERPLY_TARGET_AVX512)
using Eight = double __attribute__((vector_size(64), may_alias));

/// Records (x, y, z, w) of the lanes 0 and 4, 1 and 5, 2 and 6, 3 and 7 to the x, y, z and w of the lanes, or back.
inline void transpose(const Eight& a, const Eight& b, const Eight& c, const Eight& d, Eight out[4]) {
  const Eight xz0 = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
  const Eight yw0 = __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
  const Eight xz1 = __builtin_shufflevector(c, d, 0, 8, 2, 10, 4, 12, 6, 14);
  const Eight yw1 = __builtin_shufflevector(c, d, 1, 9, 3, 11, 5, 13, 7, 15);
  out[0] = __builtin_shufflevector(xz0, xz1, 0, 1, 8, 9, 4, 5, 12, 13);
  out[1] = __builtin_shufflevector(yw0, yw1, 0, 1, 8, 9, 4, 5, 12, 13);
  out[2] = __builtin_shufflevector(xz0, xz1, 2, 3, 10, 11, 6, 7, 14, 15);
  out[3] = __builtin_shufflevector(yw0, yw1, 2, 3, 10, 11, 6, 7, 14, 15);
}
#endif

/// The records at(l) of the lanes l.
struct Record {
  Vec3 xyz;
  Real w;
};
template <class At>
inline Record gather(const At& at) {
#if defined(INTERPLY_TARGET_AVX512)
  const auto pair = [&](int l) {
    return __builtin_shufflevector(contact::load(at(l)), contact::load(at(l + 4)), 0, 1, 2, 3, 4, 5, 6, 7);
  };
  Eight r[4];
  transpose(pair(0), pair(1), pair(2), pair(3), r);
  return {{Real(__m512d(r[0])), Real(__m512d(r[1])), Real(__m512d(r[2]))}, Real(__m512d(r[3]))};
#elif defined(INTERPLY_TARGET_AVX2)
  Four r[4] = {contact::load(at(0)), contact::load(at(1)), contact::load(at(2)), contact::load(at(3))};
  transpose(r[0], r[1], r[2], r[3]);
  return {{Real(__m256d(r[0])), Real(__m256d(r[1])), Real(__m256d(r[2]))}, Real(__m256d(r[3]))};
#else
  const Quad& q = at(0);
  return {{q.x, q.y, q.z}, q.w};
#endif
}
/// A part of the nodes with the numbers `i`.
template <Quad Node::*kPart>
inline Record gather(const Node* nodes, const Indices& i) {
  return gather([&](int l) -> const Quad& { return nodes[i[l]].*kPart; });
}
/// A part of the nodes with the numbers of the lanes.
template <Quad Node::*kPart, class Lanes>
inline Record load(const Lanes& lanes, const Node* nodes) {
  const Node* const first = nodes + lanes.begin();
  const int last = lanes.count() - 1;
  return gather([&](int l) -> const Quad& { return first[l < last ? l : last].*kPart; });
}

/// Stores the vectors of the lanes into records `stride` apart.
template <class Lanes>
inline void store([[maybe_unused]] const Lanes& lanes, Quad* first, [[maybe_unused]] Index stride, const Vec3& a) {
#if defined(INTERPLY_TARGET_AVX512)
  Eight q[4];
  transpose(Eight(a.x.data), Eight(a.y.data), Eight(a.z.data), Eight{}, q);
  for (int l = 0; l < 4; ++l) {
    if (l < lanes.count()) contact::store(first[l * stride], __builtin_shufflevector(q[l], q[l], 0, 1, 2, 3));
    if (l + 4 < lanes.count()) contact::store(first[(l + 4) * stride], __builtin_shufflevector(q[l], q[l], 4, 5, 6, 7));
  }
#elif defined(INTERPLY_TARGET_AVX2)
  Four q[4] = {Four(a.x.data), Four(a.y.data), Four(a.z.data), Four{}};
  transpose(q[0], q[1], q[2], q[3]);
  for (int l = 0; l < 4; ++l)
    if (l < lanes.count()) contact::store(first[l * stride], q[l]);
#else
  *first = {a.x, a.y, a.z, 0};
#endif
}

}  // namespace
}  // namespace interply::contact
