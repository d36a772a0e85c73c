/// The contact law of several points at once, as advance_point() of points.hpp has it for one. For kernel sources only.
#pragma once

#include "contact/kernels.hpp"
#include "contact/record_packs.hpp"

namespace interply::contact {
namespace {

template <class Lanes>
inline Vec3 load(const Lanes& lanes, const ConstRows& rows) {
  return lanes.load(rows.x, rows.y, rows.z);
}
template <class Lanes>
inline Vec3 load(const Lanes& lanes, const Rows& rows) {
  return lanes.load(rows.x, rows.y, rows.z);
}

/// Bit l: `m` holds in lane l.
template <class Lanes>
inline unsigned find_lanes(const Lanes& lanes, const Mask<Real>& m) {
#if defined(INTERPLY_TARGET_AVX512)
  const unsigned bits = m.data;
#elif defined(INTERPLY_TARGET_AVX2)
  const auto bits = static_cast<unsigned>(_mm256_movemask_pd(m.data));
#else
  const unsigned bits = m;
#endif
  return bits & ((1u << lanes.count()) - 1);
}

/// Stores whole numbers.
template <class Lanes>
inline void store_numbers(const Lanes& lanes, int* row, const Real& a) {
  alignas(64) double values[kWidth];
  write_lanes(values, a);
  int numbers[kWidth];
  for (int l = 0; l < kWidth; ++l) numbers[l] = static_cast<int>(values[l]);
  for (int l = 0; l < lanes.count(); ++l) row[lanes.begin() + l] = numbers[l];
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
[[gnu::always_inline]] inline Force advance_points(const Rows& p, const Lanes& lanes, const Motion& m,
                                                   const Real& old_gap, Sums& sums) {
  const Real zero(0.0), half(0.5), k(p.law.stiffness), kt(p.law.tangential);
  const PointRows& q = p.points;
  const Mask<Real> closed = m.gap < zero;
  const Real area = lanes.load(q.area), both = half * area;
  const Real old_weight = lanes.load(q.weight), old_elastic = select(old_gap < zero, -(k * old_gap), zero);
  const Real old_damping = lanes.load(q.pressure) - old_elastic;
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
  const Vec3 old_traction = -kt * load(lanes, q.stick);

  const Real gain = dot(old_weight * old_traction + m.weight * traction, slide);  // minus twice the work, per area
  sums.friction.add(lanes, -(both * gain));
  sums.damping.add(lanes, both * (old_weight * old_damping + m.weight * damping) * closing);
  sums.thinning.add(lanes, both * (old_weight * old_elastic + m.weight * elastic) * (m.height - old_height));
  sums.edge.add(lanes, both * kt * (m.weight - old_weight) * dot(m.start, stick));
  const Real depth = min(m.gap, zero);
  sums.stored.add(lanes, both * m.weight * (k * depth * depth + kt * dot(stick, stick)));

  const Real slipped = (Real(1.0) - kept) * length;
  const auto store_changed = [&](double* row, const Real& old, const Real& now) {  // clean cache lines stay clean
    if (any(now != old)) lanes.store(row, now);
  };
  const Real old_slip = lanes.load(q.slip), old_work = lanes.load(q.friction_work);
  const Mask<Real> acts = (min(m.gap, old_gap) < zero) & (max(m.weight, old_weight) > zero);
  store_changed(q.slip, old_slip, old_slip + select(acts, slipped, zero));
  store_changed(q.friction_work, old_work, old_work - half * gain);
  store_changed(q.weight, old_weight, m.weight);
  if (p.dt == 0)
    lanes.store(q.height, m.height);
  else
    store_changed(q.height, old_height, m.height);
  lanes.store(q.gap, m.gap);
  lanes.store(q.pressure, pressure);
  lanes.store(q.stick.x, q.stick.y, q.stick.z, stick);
  const Real touching = select(slides, Real(2.0), Real(1.0));
  const Real state = select(m.passed > zero, Real(3.0), select(closed, touching, zero));
  store_numbers(lanes, q.state, state);
  return {m.weight * area * elastic, (m.weight * area) * (traction - damping * m.normal)};
}

}  // namespace
}  // namespace interply::contact
