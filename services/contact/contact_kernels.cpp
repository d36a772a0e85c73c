/// Nodes of a lower layer against the smooth surface of the upper one, several at once: (C1) to (C4) of THEORY.md. The
/// plain forms are in smooth_facet.hpp, layer_interface_plain.cpp and points.hpp.
#include "contact/kernels.hpp"
#include "contact/law_kernels.hpp"
#include "simd/pack.hpp"

namespace interply::contact {
namespace {

/// The facets that the lanes face.
struct Facet {
  Indices node[3];
  Vec3 x[3], u, v, area;   ///< corners, x_2 - x_1, x_3 - x_1, u x v
  Real half_thickness[3];  ///< at the corners
};

inline void load_facet(const PairRows& p, const Indices& t, Facet& f) {
  for (int k = 0; k < 3; ++k) {
    for (int l = 0; l < kWidth; ++l) f.node[k][l] = p.corner[k][t[l]];
    const Record corner = gather<&Node::position>(p.upper, f.node[k]);
    f.x[k] = corner.xyz;
    f.half_thickness[k] = corner.w;
  }
  f.u = f.x[1] - f.x[0];
  f.v = f.x[2] - f.x[0];
  f.area = cross(f.u, f.v);
}

/// A point projected along a direction, as in pairing.hpp.
struct Foot {
  Real w[3], distance;
  Real rise, inverse;  ///< n.(u x v) and one over it
};

inline Foot project(const Facet& f, const Vec3& x, const Vec3& n) {
  const Vec3 r = x - f.x[0];
  Foot foot;
  foot.rise = dot(n, f.area);
  foot.inverse = Real(1.0) / foot.rise;
  foot.w[1] = dot(n, cross(r, f.v)) * foot.inverse;
  foot.w[2] = dot(n, cross(f.u, r)) * foot.inverse;
  foot.w[0] = Real(1.0) - foot.w[1] - foot.w[2];
  foot.distance = -(dot(r, f.area) * foot.inverse);
  return foot;
}

/// project(f, x + a n, m) for a point whose foot along n is known.
inline Foot project_again(const Facet& f, const Foot& foot, const Vec3& n, const Real& a, const Vec3& m) {
  const Vec3 q = cross(m, n);
  const Real above = a - foot.distance;  // of the plane along n
  Foot next;
  next.rise = dot(m, f.area);
  next.inverse = Real(1.0) / next.rise;
  const Real scale = above * next.inverse;
  next.w[1] = foot.w[1] + scale * dot(q, f.v);
  next.w[2] = foot.w[2] - scale * dot(q, f.u);
  next.w[0] = Real(1.0) - next.w[1] - next.w[2];
  next.distance = -(scale * foot.rise);
  return next;
}

/// Lanes whose nodes have left their triangles (law.hpp).
inline Mask<Real> has_left(const Foot& foot) {
  const Real *w = foot.w, least = min(min(w[0], w[1]), w[2]), most = max(max(w[0], w[1]), w[2]);
  return least < Real(kOnSide) && (least <= Real(-kAtCorner) || most <= Real(1 - kAtCorner));
}

/// Share of the nodes that are beyond the partner's edge, and the gradient of the weight w_k that says so.
struct Edge {
  bool any = false;
  Real share = Real(1.0);
  Real fade = Real(0.0);                    ///< 1 where 0 < share < 1, else 0
  Real by_2 = Real(0.0), by_3 = Real(0.0);  ///< dw_k/dw_2, dw_k/dw_3 at w_1 = 1 - w_2 - w_3
};

/// Lets the lanes that have left their triangles walk; facets and feet are then those of the new ones. Together as long
/// as they go from neighbour to neighbour inside the partner, which is what find_facing() does, else on their own.
template <class Lanes>
[[gnu::noinline]] Edge walk(const PairRows& p, const Lanes& lanes, const Vec3& x, const Vec3& n, Facet& facet,
                            Foot& foot, double& edge_energy) {
  constexpr int kTogether = 3;
  unsigned alone = 0;  // bits of the lanes
  Indices t = lanes.load(p.triangle);
  for (int walked = 0;; ++walked) {
    unsigned out = find_lanes(lanes, has_left(foot)) & ~alone;
    if (out == 0) break;
    alignas(64) double side[kWidth];  // opposite the most negative weight
    write_lanes(side, select(foot.w[2] < min(foot.w[0], foot.w[1]), Real(2.0),
                             select(foot.w[1] < foot.w[0], Real(1.0), Real(0.0))));
    for (; out != 0; out &= out - 1) {
      const int l = __builtin_ctz(out), next = p.neighbour[static_cast<int>(side[l])][t[l]];
      if (next < 0 || walked == kTogether || p.points.weight[lanes.begin() + l] < 1)
        alone |= 1u << l;
      else
        t[l] = next;
    }
    for (int l = lanes.count(); l < kWidth; ++l) t[l] = t[lanes.count() - 1];
    load_facet(p, t, facet);
    foot = project(facet, x, n);
  }
  for (int l = 0; l < lanes.count(); ++l)
    if (!(alone >> l & 1)) p.triangle[lanes.begin() + l] = t[l];
  if (alone == 0) return {};

  alignas(64) double share[kWidth], fade[kWidth], by_2[kWidth], by_3[kWidth];
  int beyond[kWidth];
  bool any = false;
  for (int l = 0; l < kWidth; ++l) {
    beyond[l] = alone >> l & 1 ? p.walk(p.owner, lanes.begin() + l, edge_energy) : -1;
    any = any || beyond[l] >= 0;
  }
  load_facet(p, lanes.load(p.triangle), facet);
  foot = project(facet, x, n);
  if (!any) return {};
  alignas(64) double w[3][kWidth];
  for (int k = 0; k < 3; ++k) write_lanes(w[k], foot.w[k]);
  for (int l = 0; l < kWidth; ++l) {
    const int k = beyond[l];
    share[l] = k < 0 ? 1 : simd::max(0.0, 1 + w[k][l] / kEdgeMargin);
    fade[l] = share[l] > 0 && share[l] < 1 ? 1 : 0;
    by_2[l] = k == 0 ? -1 : k == 1 ? 1 : 0;
    by_3[l] = k == 0 ? -1 : k == 2 ? 1 : 0;
  }
  return {true, read_lanes<Real>(share), read_lanes<Real>(fade), read_lanes<Real>(by_2), read_lanes<Real>(by_3)};
}

/// The smooth surface above a facet, (C1), in parts: side i runs from corner i to j = i + 1,
/// r = sum beta_i side_i.n_j - alpha_i side_i.n_i, dr/dn_j = beta_i side_i, dr/dn_i = -alpha_i side_i.
struct Rise {
  Real value, alpha[3], beta[3];
  Real by_weight[3];
};

inline Rise compute_rise(const Facet& f, const Vec3 n[3], const Real w[3]) {
  const Real half(0.5), one(1.0);
  const Vec3 side[3] = {f.u, f.x[2] - f.x[1], f.x[0] - f.x[2]};
  Rise r;
  for (Real& b : r.by_weight) b = Real(0.0);
  r.value = Real(0.0);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const Real at_i = half * dot(side[i], n[i]), at_j = half * dot(side[i], n[j]);
    const Real even = at_j - at_i, odd = at_i + at_j, skew = w[i] - w[j], both = half * w[i] * w[j];
    r.alpha[i] = both * (one + skew);
    r.beta[i] = both * (one - skew);
    r.value += w[i] * w[j] * (even - skew * odd);
    r.by_weight[i] += w[j] * (even - (skew + w[i]) * odd);
    r.by_weight[j] += w[i] * (even - (skew - w[j]) * odd);
  }
  return r;
}

/// Elastic stick carried along with the facet, laid across n, its length kept.
inline Vec3 carry_along(const Facet& f, const Vec3 increment[3], const Vec3& n, const Vec3& e) {
  const Real one(1.0);
  const Vec3 u = f.u - (increment[1] - increment[0]), v = f.v - (increment[2] - increment[0]);
  const Vec3 area = cross(u, v);
  const Real inverse = one / dot(area, area);
  const Real uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), eu = dot(e, u), ev = dot(e, v);
  const Vec3 in_plane = combine(inverse * combine(eu, vv, -ev, uv), f.u, inverse * combine(ev, uu, -eu, uv), f.v);
  const Vec3 carried = in_plane + (inverse * dot(e, area)) * f.area;
  return lay_across(carried, n, e);
}

/// Marks the lanes that have passed the partner (State::Passed): their share is 0.
template <class Lanes>
Real mark_passed(const PairRows& p, const Lanes& lanes, const Real& gap, const Real& height, Edge& edge) {
  const Real zero(0.0), one(1.0);
  if (!edge.any && simd::all(lanes.load(p.points.weight) > zero)) return zero;  // who has passed has no weight
  alignas(64) double before[kWidth];
  bool any = edge.any;
  for (int l = 0; l < kWidth; ++l) {
    const bool passed = l < lanes.count() && p.points.state[lanes.begin() + l] == static_cast<int>(State::Passed);
    before[l] = passed;
    any = any || passed;
  }
  if (!any) return zero;
  const Mask<Real> deep = gap < Real(-kPassedDepth) * height;
  const Real is_new = select(edge.share > zero, zero, select(deep, one, zero));
  const Real passed = select(gap < zero, max(read_lanes<Real>(before), is_new), zero);
  edge.share = select(passed > zero, zero, edge.share);
  edge.fade = select(passed > zero, zero, edge.fade);
  return passed;
}

template <class Lanes>
inline void advance_pack(const PairRows& p, const Lanes& lanes, Quad* upper_force, Sums& sums, double& edge_energy) {
  const Real zero(0.0), half(0.5), one(1.0);
  const Record own = load<&Node::position>(lanes, p.lower);
  const Vec3 x = own.xyz, n = load<&Node::normal>(lanes, p.lower).xyz;
  Facet f;
  load_facet(p, lanes.load(p.triangle), f);
  Foot foot = project(f, x, n);
  Edge edge;
  if (any(has_left(foot))) edge = walk(p, lanes, x, n, f, foot, edge_energy);

  // gap, (C1)
  Vec3 normal[3];
  Real height = own.w;
  for (int k = 0; k < 3; ++k) {
    normal[k] = gather<&Node::normal>(p.upper, f.node[k]).xyz;
    height += foot.w[k] * f.half_thickness[k];
  }
  const Rise rise = compute_rise(f, normal, foot.w);
  const Real distance = foot.distance + rise.value, gap = distance - height, old_gap = lanes.load(p.points.gap);
  const bool acts = any(min(gap, old_gap) < zero);
  for (int l = 0; l < lanes.count(); ++l) p.touches[lanes.begin() + l] = acts;
  Quad* const lower = p.lower_force + 2 * lanes.begin();
  if (!acts) {  // open, and stays so
    lanes.store(p.points.gap, gap);
    lanes.store(p.points.height, height);
    lanes.store(p.points.weight, edge.share);
    for (int l = 0; l < 2 * lanes.count(); ++l) lower[l] = {};
    return;
  }

  const Real passed = mark_passed(p, lanes, gap, height, edge);

  // friction and damper at the common point (C4)
  const Real below = distance * own.w / height;  // a
  const Vec3 m = combine(foot.w[0], normal[0], foot.w[1], normal[1]) + foot.w[2] * normal[2];
  const Foot common = project_again(f, foot, n, below, m);
  Vec3 increment[3];
  Vec3 slip = load<&Node::increment>(lanes, p.lower).xyz + below * load<&Node::turn>(lanes, p.lower).xyz;
  Vec3 turned{zero, zero, zero};
  for (int k = 0; k < 3; ++k) {
    increment[k] = gather<&Node::increment>(p.upper, f.node[k]).xyz;
    slip -= common.w[k] * increment[k];
    turned += foot.w[k] * gather<&Node::turn>(p.upper, f.node[k]).xyz;
  }
  slip += common.distance * turned;
  const Vec3 start = carry_along(f, increment, n, load(lanes, p.points.stick));
  const Force force = advance_points(p, lanes, {gap, height, edge.share, passed, n, start, slip}, old_gap, sums);

  // (C2), (C3): minus the gradient of the penalty energy
  const Real inverse_square = one / dot(f.area, f.area);
  const Real uu = dot(f.u, f.u), uv = dot(f.u, f.v), vv = dot(f.v, f.v);
  const auto gradient = [&](const Real& by_2, const Real& by_3) {  // of a function of w_2 and w_3
    return combine(inverse_square * combine(by_2, vv, -by_3, uv), f.u, inverse_square * combine(by_3, uu, -by_2, uv),
                   f.v);
  };
  const Vec3 along = foot.inverse * f.area;  // N/(n.N)
  const Vec3 slope = gradient(rise.by_weight[1] - rise.by_weight[0], rise.by_weight[2] - rise.by_weight[0]);
  Vec3 push = force.pressing * ((one + dot(slope, n)) * along - slope);
  if (edge.any) {
    const Real depth = min(gap, zero);
    const Vec3 g = gradient(edge.by_2, edge.by_3);
    push += (edge.fade * half * Real(p.law.stiffness / kEdgeMargin) * lanes.load(p.points.area) * depth * depth) *
            (g - dot(g, n) * along);
  }
  store(lanes, lower, 2, force.drag - push);
  store(lanes, lower + 1, 2, combine(below, force.drag, -foot.distance, push));
  const Vec3 side[3] = {f.u, f.x[2] - f.x[1], f.x[0] - f.x[2]};
  Real alpha[3], beta[3];
  for (int k = 0; k < 3; ++k) {
    alpha[k] = force.pressing * rise.alpha[k];
    beta[k] = force.pressing * rise.beta[k];
  }
  for (int k = 0; k < 3; ++k) {
    const int before = (k + 2) % 3, after = (k + 1) % 3;  // sides that end and begin at corner k
    const Vec3 on_corner =
        combine(beta[before] + alpha[k], normal[k], -alpha[before], normal[before]) - beta[k] * normal[after];
    const Vec3 on_normal = combine(beta[before], side[before], -alpha[k], side[k]);
    Quad* const upper = upper_force + 2 * k;
    store(lanes, upper, 6, foot.w[k] * push + on_corner - common.w[k] * force.drag);
    store(lanes, upper + 1, 6, on_normal + (common.distance * foot.w[k]) * force.drag);
  }
}

void advance_pairs(const PairRows& p, Index begin, Index end, Quad* upper_force, InterfaceEnergies& energies) {
  Sums sums(begin);
  double edge_energy = 0;
  simd::for_each_pack<Real>(begin, end, [&](const auto& lanes) {
    advance_pack(p, lanes, upper_force + 6 * (lanes.begin() - begin), sums, edge_energy);
  });
  sums.add_to(energies);
  energies.edge += edge_energy;
}

void add_upper_forces(const PairRows& p, Index begin, Index end, const Quad* upper_force, Quad* records) {
  for (Index i = begin; i < end; ++i, upper_force += 6) {
    if (!p.touches[i]) continue;
    for (int k = 0; k < 3; ++k) {
      Quad* const to = records + 2 * p.corner[k][p.triangle[i]];
      add_to(to[0], contact::load(upper_force[2 * k]));
      add_to(to[1], contact::load(upper_force[2 * k + 1]));
    }
  }
}

}  // namespace

template <>
const ContactKernels& get_contact_kernels<simd::Target>() {
  static constexpr ContactKernels kernels{advance_pairs, add_upper_forces};
  return kernels;
}

}  // namespace interply::contact
