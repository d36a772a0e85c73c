/// The shell of edge_shell.hpp for packs of elements. For kernel sources only (simd/pack.hpp).
///
/// Pass 1, by the solver's kernel: compute_facet(), store_facet(); then reflect_facets() for the whole shell.
/// Pass 2, by the solver's kernel: load_facet(), compute_curvature(), its own law, store_moments(), store_membrane().
/// Pass 3 and the rest, which no law enters: mechanics/shell_passes.hpp.
#pragma once

#include "mechanics/shell_rows.hpp"
#include "simd/pack.hpp"

namespace interply::mechanics {
namespace {

using simd::Vec3;

/// SurfaceGradient of edge_shell.hpp.
template <class Real>
struct Facet {
  Vec3<Real> f1, f2, t3;
  Real area_ratio;
};

/// dN_k/dX_1 and dN_k/dX_2.
template <class Real>
struct Gradient {
  Real n1[3], n2[3];
};

template <class Real, class Lanes>
inline Gradient<Real> load_gradient(const ShellRows& s, const Lanes& lanes) {
  Gradient<Real> g;
  for (int k = 0; k < 3; ++k) {
    g.n1[k] = lanes.load(s.gradient[2 * k]);
    g.n2[k] = lanes.load(s.gradient[2 * k + 1]);
  }
  return g;
}

/// @param x  rows of the nodal positions
template <class Real, class Lanes>
inline Facet<Real> compute_facet(const ShellRows& s, const Lanes& lanes, const double* const x[3]) {
  const Gradient<Real> g = load_gradient<Real>(s, lanes);
  const auto at = [&](int k) { return simd::gather<Real>(x[0], x[1], x[2], lanes.load(s.node[k])); };
  // the gradients of the three corners add up to zero
  const Vec3<Real> x0 = at(0), u = at(1) - x0, v = at(2) - x0;
  Facet<Real> f;
  f.f1 = g.n1[1] * u + g.n1[2] * v;
  f.f2 = g.n2[1] * u + g.n2[2] * v;
  const Vec3<Real> n = cross(f.f1, f.f2);
  f.area_ratio = simd::sqrt(dot(n, n));
  f.t3 = (Real(1.0) / f.area_ratio) * n;
  return f;
}

template <class Real, class Lanes>
inline void store_facet(const ShellRows& s, const Lanes& lanes, const Facet<Real>& f) {
  const Lanes own = lanes.moved(s.facets.shift);
  own.store(s.f1[0], s.f1[1], s.f1[2], f.f1);
  own.store(s.f2[0], s.f2[1], s.f2[2], f.f2);
  own.store(s.t3[0], s.t3[1], s.t3[2], f.t3);
  own.store(s.area_ratio, f.area_ratio);
}

template <class Real, class Lanes>
inline Facet<Real> load_facet(const ShellRows& s, const Lanes& lanes) {
  const Lanes own = lanes.moved(s.facets.shift);
  return {own.load(s.f1[0], s.f1[1], s.f1[2]), own.load(s.f2[0], s.f2[1], s.f2[2]), own.load(s.t3[0], s.t3[1], s.t3[2]),
          own.load(s.area_ratio)};
}

/// From corner k + 1 to k + 2: 2 A (N_k,2 f1 - N_k,1 f2).
template <class Real>
inline Vec3<Real> compute_edge(const Facet<Real>& f, const Gradient<Real>& g, const Real& area, int k) {
  const Real twice = area + area;
  return (twice * g.n2[k]) * f.f1 - (twice * g.n1[k]) * f.f2;
}

/// Curvature of edge_shell.hpp with what store_moments() needs.
template <class Real>
struct PackCurvature {
  Real k11, k22, k12;
  Gradient<Real> gradient;
  Real area, height[3], slope[3], hinge_factor[3];
};

/// (B1) to (B3). @param phi  rotation of each edge
template <class Real, class Lanes>
inline PackCurvature<Real> compute_curvature(const ShellRows& s, const Lanes& lanes, const Facet<Real>& f,
                                             const double* phi) {
  PackCurvature<Real> c;
  c.gradient = load_gradient<Real>(s, lanes);
  c.area = lanes.load(s.area);
  c.k11 = c.k22 = c.k12 = Real(0.0);
  const Real twice_area = Real(2.0) * c.area * f.area_ratio;  // current
  for (int k = 0; k < 3; ++k) {
    const Vec3<Real> edge = compute_edge(f, c.gradient, c.area, k);
    const Vec3<Real> across = simd::gather<Real>(s.t3[0], s.t3[1], s.t3[2], lanes.load(s.across[k]));
    const Real length = simd::sqrt(dot(edge, edge));
    const Real cosine = simd::sqrt(Real(0.5) * (Real(1.0) + dot(f.t3, across)));  // of theta/2
    const Real inverse = Real(1.0) / (length * cosine), hinged = lanes.load(s.hinged[k]);
    c.height[k] = twice_area * (inverse * cosine);
    const Real turn = lanes.load(s.side[k]) * simd::gather<Real>(phi, lanes.load(s.edge[k]));
    c.slope[k] = simd::fuse(Real(0.5) * hinged * inverse, dot(edge, cross(across, f.t3)), turn);  // (B1), (B2)
    c.hinge_factor[k] = Real(0.5) * hinged * cosine;
    const Real n1 = c.gradient.n1[k], n2 = c.gradient.n2[k], a = Real(2.0) * c.height[k] * c.slope[k];
    c.k11 += a * n1 * n1;  // (B3)
    c.k22 += a * n2 * n2;
    c.k12 += a * n1 * n2;
  }
  return c;
}

/// (B4).
template <class Real, class Lanes>
inline void store_moments(const ShellRows& s, const Lanes& lanes, const PackCurvature<Real>& c, const Real& m11,
                          const Real& m22, const Real& m12) {
  const Lanes own = lanes.moved(s.moments.shift);
  for (int k = 0; k < 3; ++k) {
    const Real n1 = c.gradient.n1[k], n2 = c.gradient.n2[k];
    const Real twice_q = Real(2.0) * c.area * (m11 * n1 * n1 + m22 * n2 * n2 + Real(2.0) * m12 * n1 * n2);
    own.store(s.slope_moment + k * s.moments.stride, c.height[k] * twice_q);
    own.store(s.height_force + k * s.moments.stride, c.slope[k] * twice_q);
    own.store(s.hinge_factor + k * s.moments.stride, c.hinge_factor[k]);
  }
}

/// n_ab times the reference area, N mm.
template <class Real, class Lanes>
inline void store_membrane(const ShellRows& s, const Lanes& lanes, const Real& n11, const Real& n22, const Real& n12) {
  lanes.moved(s.facets.shift).store(s.membrane[0], s.membrane[1], s.membrane[2], {n11, n22, n12});
}

}  // namespace
}  // namespace interply::mechanics
