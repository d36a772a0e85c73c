/// The contact law of several points at once, as advance_point() of points.hpp has it for one. For kernel sources only.
#pragma once

#include "contact/kernels.hpp"
#include "simd/pack.hpp"

namespace interply::contact {
namespace {

using simd::any;
using simd::dot;
using simd::gather;
using simd::Index;
using simd::Mask;
using simd::max;
using simd::min;
using simd::select;
using simd::sqrt;
using Real = simd::Pack;
using Vec3 = simd::Vec3<Real>;
constexpr int kWidth = simd::kWidth<Real>;
using Indices = std::array<int, kWidth>;

inline Vec3 gather(const ConstRows& rows, const Indices& i) { return gather<Real>(rows.x, rows.y, rows.z, i); }
template <class Lanes>
inline Vec3 load(const Lanes& lanes, const ConstRows& rows) {
  return lanes.load(rows.x, rows.y, rows.z);
}
template <class Lanes>
inline Vec3 load(const Lanes& lanes, const Rows& rows) {
  return lanes.load(rows.x, rows.y, rows.z);
}

/// A pack as an array of its lanes, and back.
template <class R>
inline void spread(const R& a, double* to) {
  if constexpr (simd::kWidth<R> == 1)
    *to = a;
  else
    a.store_aligned(to);
}
template <class R>
inline R collect(const double* from) {
  if constexpr (simd::kWidth<R> == 1)
    return *from;
  else
    return R::load_aligned(from);
}

/// Stores whole numbers.
template <class Lanes>
inline void store_numbers(const Lanes& lanes, int* row, const Real& a) {
  alignas(64) double values[kWidth];
  spread(a, values);
  int numbers[kWidth];
  for (int l = 0; l < kWidth; ++l) numbers[l] = static_cast<int>(values[l]);
  for (int l = 0; l < lanes.count(); ++l) row[lanes.begin() + l] = numbers[l];
}

/// Stores the vectors of the lanes into records `stride` apart.
template <class Lanes>
inline void store(const Lanes& lanes, Quad* first, Index stride, const Vec3& a) {
  alignas(64) double rows[3][kWidth];
  spread(a.x, rows[0]);
  spread(a.y, rows[1]);
  spread(a.z, rows[2]);
  if constexpr (kWidth == 1) {
    *first = {rows[0][0], rows[1][0], rows[2][0], 0};
  } else {
    for (int l = 0; l < kWidth; l += 4) {
      Four q[4];
      for (int d = 0; d < 3; ++d) q[d] = *reinterpret_cast<const Four*>(rows[d] + l);
      q[3] = Four{0, 0, 0, 0};
      transpose(q[0], q[1], q[2], q[3]);
      for (int k = 0; k < 4; ++k)
        if (l + k < lanes.count()) contact::store(first[(l + k) * stride], q[k]);
    }
  }
}

/// The elastic stick e across the normal after `carried`, of the same length.
inline Vec3 lay_across(const Vec3& carried, const Vec3& n, const Vec3& e) {
  const Real zero(0.0);
  const Vec3 start = carried - dot(carried, n) * n;
  const Real turned = dot(start, start);
  return select(turned > zero, sqrt(dot(e, e) / turned), zero) * start;
}

struct Sums {
  simd::Sum<Real> stored, friction, damping, thinning, edge;
  explicit Sums(Index begin) : stored(begin), friction(begin), damping(begin), thinning(begin), edge(begin) {}
  void add_to(InterfaceEnergies& e) const {
    e.stored += stored.total();
    e.friction += friction.total();
    e.damping += damping.total();
    e.thinning += thinning.total();
    e.edge += edge.total();
  }
};

/// What a point gives, as in points.hpp.
struct Force {
  Real pressing;
  Vec3 drag;
};

struct Motion {
  Real gap, height, weight;
  Real passed;               ///< 1: State::Passed, else 0
  Vec3 normal, start, slip;  ///< start: elastic stick, carried along and laid across the normal
};

/// advance_point() of points.hpp; points that were open and stay so keep their slip.
template <class Rows, class Lanes>
inline Force advance_points(const Rows& p, const Lanes& lanes, const Motion& m, const Real& old_gap, Sums& sums) {
  const Real zero(0.0), half(0.5), k(p.law.stiffness), kt(p.law.tangential);
  const PointRows& q = p.points;
  const Mask<Real> closed = m.gap < zero;
  const Real area = lanes.load(q.area), both = half * area;
  const Real old_weight = lanes.load(q.weight), old_damping = lanes.load(q.damping);
  const Real old_height = p.dt == 0 ? m.height : lanes.load(q.height);
  const Real closing = dot(m.slip, m.normal);
  const Real elastic = select(closed, -(k * m.gap), zero);
  const Real damped = p.dt > 0 ? elastic + (p.law.damping / p.dt) * closing : elastic;
  const Real pressure = select(closed, max(damped, zero), zero);
  const Real damping = pressure - elastic;
  const Vec3 trial = m.start + m.slip - closing * m.normal;
  const Real length = sqrt(dot(trial, trial)), limit = Real(p.law.friction) * pressure;
  const Mask<Real> slides = kt * length > limit;
  const Real kept = select(slides, limit / (kt * length), Real(1.0));
  const Vec3 stick = kept * trial, slide = trial - stick, traction = -kt * stick;
  const Vec3 old_traction = load(lanes, q.traction);

  sums.friction.add(lanes, -(both * dot(old_weight * old_traction + m.weight * traction, slide)));
  sums.damping.add(lanes, both * (old_weight * old_damping + m.weight * damping) * closing);
  sums.thinning.add(lanes, both * (old_weight * (lanes.load(q.pressure) - old_damping) + m.weight * elastic) *
                               (m.height - old_height));
  sums.edge.add(lanes, both * kt * (m.weight - old_weight) * dot(m.start, stick));
  const Real depth = min(m.gap, zero);
  sums.stored.add(lanes, both * m.weight * (k * depth * depth + kt * dot(stick, stick)));

  const Real slipped = sqrt(dot(slide, slide));
  lanes.store(q.slip, lanes.load(q.slip) + select(min(m.gap, old_gap) < zero, slipped, zero));
  lanes.store(q.gap, m.gap);
  lanes.store(q.weight, m.weight);
  lanes.store(q.height, m.height);
  lanes.store(q.pressure, pressure);
  lanes.store(q.damping, damping);
  lanes.store(q.stick.x, q.stick.y, q.stick.z, stick);
  lanes.store(q.traction.x, q.traction.y, q.traction.z, traction);
  const Real touching = select(slides, Real(2.0), Real(1.0));
  const Real state = select(m.passed > zero, Real(3.0), select(closed, touching, zero));
  store_numbers(lanes, q.state, state);
  return {m.weight * area * elastic, (m.weight * area) * (traction - damping * m.normal)};
}

}  // namespace
}  // namespace interply::contact
