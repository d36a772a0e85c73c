/// Isotropic hardening curves: yield stress over equivalent plastic strain. Each is a functor over `Real`, one double
/// or a pack of them (simd/pack.hpp); what a point gets does not depend on the others in its pack. A curve of its own
/// needs its parameters (proto/scene.proto, scene/scene.hpp, scene/convert.cpp) and a functor here.
#pragma once

#include "scene/scene.hpp"
#include "simd/pack.hpp"

namespace interply::metal {

/// sigma_y(p) and its first two derivatives, MPa.
template <class Real>
struct YieldStress {
  Real stress, slope, bend;
};

/// The curve at the equivalent plastic strain p >= 0. At 0 the slope of Hockett-Sherby may be huge.
YieldStress<double> compute_yield_stress(const scene::Hardening& hardening, double p);

namespace {

/// Made from the parameters of a scene.
template <class Parameters>
struct Curve;

/// K (e0 + p)^n                                                                                        (H1)
/// @pre e0 > 0
template <>
struct Curve<scene::Swift> {
  scene::Swift c;
  template <class Real>
  YieldStress<Real> operator()(const Real& p) const {
    const Real base = Real(c.e0) + p, per_base = Real(1.0) / base;
    const Real stress = Real(c.K) * simd::exp(Real(c.n) * simd::log(base));  // (H1)
    const Real slope = Real(c.n) * stress * per_base;
    return {stress, slope, Real(c.n - 1) * slope * per_base};
  }
};

/// s_inf - (s_inf - s0) exp(-rate p)                                                                   (H2)
template <>
struct Curve<scene::Voce> {
  scene::Voce c;
  template <class Real>
  YieldStress<Real> operator()(const Real& p) const {
    const Real missing = Real(c.s_inf - c.s0) * simd::exp(Real(-c.rate) * p);
    return {Real(c.s_inf) - missing, Real(c.rate) * missing, Real(-c.rate * c.rate) * missing};  // (H2)
  }
};

/// s_inf - (s_inf - s0) exp(-rate p^n)                                                                 (H3)
/// @pre p > 0
template <>
struct Curve<scene::HockettSherby> {
  scene::HockettSherby c;
  template <class Real>
  YieldStress<Real> operator()(const Real& p) const {
    const Real power = Real(c.rate) * simd::exp(Real(c.n) * simd::log(p)), per_p = Real(1.0) / p;
    const Real missing = Real(c.s_inf - c.s0) * simd::exp(-power), growth = Real(c.n) * power * per_p;
    const Real slope = missing * growth;
    return {Real(c.s_inf) - missing, slope, slope * (Real(c.n - 1) * per_p - growth)};  // (H3)
  }
};

/// Piecewise linear, constant before its first and beyond its last point; point by point. The table outlives it.
template <>
struct Curve<scene::HardeningTable> {
  explicit Curve(const scene::HardeningTable& table)
      : points(table.points.data()->data()), end(points + 2 * table.points.size()) {}
  const double *points, *end;  // strain, stress (MPa), strain, stress, ...

  template <class Real>
  YieldStress<Real> operator()(const Real& p) const {
    constexpr int kWidth = simd::kWidth<Real>;
    const simd::Lanes<Real, false> all(0, kWidth);
    double at[kWidth], stress[kWidth], slope[kWidth];
    all.store(at, p);
    for (int l = 0; l < kWidth; ++l) interpolate(at[l], stress[l], slope[l]);
    return {all.load(stress), all.load(slope), Real(0.0)};
  }

 private:
  void interpolate(double p, double& stress, double& slope) const {
    const double* right = points;  // the first point beyond p
    while (right < end && right[0] <= p) right += 2;
    if (right == points || right == end) {
      stress = right == end ? end[-1] : right[1];
      slope = 0;
      return;
    }
    const double* const left = right - 2;
    slope = (right[1] - left[1]) / (right[0] - left[0]);
    stress = left[1] + slope * (p - left[0]);
  }
};

/// body(curve) for the curve of a law. (std::visit would put what it throws into the kernels.)
template <std::size_t kIndex = 0, class Body>
inline auto with_curve(const scene::Hardening& hardening, const Body& body) {
  if constexpr (kIndex + 1 < std::variant_size_v<scene::Hardening>)
    if (hardening.index() != kIndex) return with_curve<kIndex + 1>(hardening, body);
  using Parameters = std::variant_alternative_t<kIndex, scene::Hardening>;
  return body(Curve<Parameters>{*std::get_if<kIndex>(&hardening)});
}

}  // namespace
}  // namespace interply::metal
