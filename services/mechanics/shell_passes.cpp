#include "mechanics/shell_passes.hpp"

#include "mechanics/shell_kernels.hpp"

namespace interply::mechanics {
namespace {

using simd::Index;
using Real = simd::Pack;

void reflect_facets(const ShellRows& s, Index begin, Index end) {
  const double* const* mirror = s.image_plane;
  for (Index i = begin; i < end; ++i) {
    const Index e = s.image_facet[i], image = s.facets.stride + i;
    const double twice = 2 * (mirror[0][i] * s.t3[0][e] + mirror[1][i] * s.t3[1][e]);
    s.t3[0][image] = s.t3[0][e] - twice * mirror[0][i];
    s.t3[1][image] = s.t3[1][e] - twice * mirror[1][i];
    s.t3[2][image] = s.t3[2][e];
  }
}

template <class Lanes>
void compute_corner_forces(const ShellRows& s, const Lanes& lanes) {
  const Lanes facet = lanes.moved(s.facets.shift), side = lanes.moved(s.moments.shift);
  const Facet<Real> f = load_facet<Real>(s, lanes);
  const Gradient<Real> g = load_gradient<Real>(s, lanes);
  const Real area = lanes.load(s.area), per_area = Real(0.5) / (area * f.area_ratio);
  const Real n11 = facet.load(s.membrane[0]), n22 = facet.load(s.membrane[1]), n12 = facet.load(s.membrane[2]);
  const Vec3<Real> p1 = n11 * f.f1 + n12 * f.f2, p2 = n12 * f.f1 + n22 * f.f2;
  Vec3<Real> force[3], edge[3];
  for (int k = 0; k < 3; ++k) {
    force[k] = g.n1[k] * p1 + g.n2[k] * p2;
    edge[k] = compute_edge(f, g, area, k);
  }
  for (int k = 0; k < 3; ++k) {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const Real own = side.load(s.slope_moment + k * s.moments.stride);
    const Real beyond = simd::gather<Real>(s.slope_moment, lanes.load(s.opposite[k]));
    const Real hinge = side.load(s.hinge_factor + k * s.moments.stride) * (own + beyond);  // (B5)
    const Real length2 = dot(edge[k], edge[k]), length = simd::sqrt(length2), inverse = Real(1.0) / length;
    const Vec3<Real> b = (hinge * length * per_area) * f.t3 -
                         (side.load(s.height_force + k * s.moments.stride) * inverse) * cross(edge[k], f.t3);  // (B6)
    const Real at_i = -dot(edge[i], edge[k]) * (inverse * inverse);  // lever rule
    force[k] += b;
    force[i] -= at_i * b;
    force[j] -= (Real(1.0) - at_i) * b;
  }
  const Lanes corner = lanes.moved(s.corners.shift);
  for (int k = 0; k < 3; ++k) {
    const Index row = k * s.corners.stride;
    corner.store(s.corner_force[0] + row, s.corner_force[1] + row, s.corner_force[2] + row, force[k]);
  }
}

void compute_all_corner_forces(const ShellRows& s, Index begin, Index end) {
  simd::for_each_pack<Real>(begin, end, [&](const auto& lanes) { compute_corner_forces(s, lanes); });
}

void advance_edges(const EdgeRows& edges, double span, double dt, Index begin, Index end) {
  const Real half_span(0.5 * span), whole(span), step(dt), one(1.0);
  simd::for_each_pack<Real>(begin, end, [&](const auto& lanes) {
    const Real half_decay = half_span * lanes.load(edges.decay);
    const Real kick = whole * lanes.load(edges.mobility) * lanes.load(edges.torque);
    const Real rate = ((one - half_decay) * lanes.load(edges.rate) + kick) / (one + half_decay);
    lanes.store(edges.rate, rate);
    lanes.store(edges.angle, lanes.load(edges.angle) + step * rate);
  });
}

EdgeEnergies update_torques(const ShellRows& s, const EdgeRows& edges, double dt, Index begin, Index end) {
  const Real half(0.5), one(1.0), step(dt), half_step(0.5 * dt);
  simd::Sum<Real> kinetic(begin), work(begin);
  simd::for_each_pack<Real>(begin, end, [&](const auto& lanes) {
    const Real torque = simd::gather<Real>(s.slope_moment, lanes.load(s.second_side)) -
                        simd::gather<Real>(s.slope_moment, lanes.load(s.first_side));
    lanes.store(edges.torque, torque);
    const Real rate = lanes.load(edges.rate), decay = lanes.load(edges.decay), inertia = lanes.load(edges.inertia);
    const Real half_decay = half_step * decay;
    const Real next = ((one - half_decay) * rate + step * lanes.load(edges.mobility) * torque) / (one + half_decay);
    const Real friction = inertia * decay * half * (rate + next);
    kinetic.add(lanes, half * inertia * rate * next);
    work.add(lanes, half_step * (lanes.load(edges.friction) + friction) * rate);
    lanes.store(edges.friction, friction);
  });
  return {kinetic.total(), work.total()};
}

void gather_forces(const ShellRows& s, double* const force[3], Index begin, Index end) {
  for (Index i = begin; i < end; ++i) {
    double x = 0, y = 0, z = 0;
    for (int k = s.gather_start[i]; k < s.gather_start[i + 1]; ++k) {
      const int at = s.gather_entry[k];
      x += s.corner_force[0][at];
      y += s.corner_force[1][at];
      z += s.corner_force[2][at];
    }
    force[0][i] = x;
    force[1][i] = y;
    force[2][i] = z;
  }
}

}  // namespace

template <>
const ShellPassKernels& get_shell_pass_kernels<simd::Target>() {
  static constexpr ShellPassKernels kernels{reflect_facets, compute_all_corner_forces, advance_edges, update_torques,
                                            gather_forces};
  return kernels;
}

}  // namespace interply::mechanics
