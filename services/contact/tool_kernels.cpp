/// Nodes against a tool, several at once. The plain forms are in signed_distance.cpp and points.hpp. Where the
/// distances to the analytic tools try all sides and faces there, they go to the one that the nearest point lies on
/// here.
#include "contact/tool_kernels.hpp"

#include "contact/law_kernels.hpp"

namespace interply::contact {
namespace {

struct Distances {
  Real value;     ///< mm
  Vec3 gradient;  ///< unit, away from the tool
};

/// The third of the plane that a point lies in, by the side of the triangle there: the nearest point of everything that
/// has the triangle's symmetry lies in the same third, and on the same side of its middle.
struct Third {
  Real x, y;    ///< outward normal of the side
  Real out;     ///< from the centre along the normal, mm
  Real across;  ///< along the side, (-y, x), from its middle, mm
};

inline Third find_third(const Vec3& p) {
  const Real half(0.5), sine(0.86602540378443864676), aside = simd::abs(p.y);
  const Real slanted = fuse(sine, aside, half * p.x), left = -p.x;
  const Mask<Real> is_left = left > slanted;
  const Real side = select(p.y < Real(0.0), Real(-1.0), Real(1.0));
  return {select(is_left, Real(-1.0), half), side * select(is_left, Real(0.0), sine), max(left, slanted),
          side * select(is_left, -aside, fuse(half, aside, -(sine * p.x)))};
}

/// out and across to x and y.
inline Vec3 turn_back(const Third& t, const Real& out, const Real& across, const Real& z) {
  return {fuse(out, t.x, -(across * t.y)), fuse(out, t.y, across * t.x), z};
}

inline Real clamp(const Real& a, const Real& low, const Real& high) { return min(max(a, low), high); }

// measure(): distances at x to a tool. Every sum of products says which is rounded first.

template <class Lanes>
inline Distances measure(const PlateShape& plate, const Vec3& x, const Lanes&, const Mask<Real>&) {
  const Real zero(0.0), one(1.0), shoulder(plate.shoulder), up(plate.up);
  const Real h = up * x.z;  // > 0 outside the plate
  const Third third = find_third(x);
  const Real height = third.out - Real(plate.opening.inradius);  // above the side of the triangle
  const Mask<Real> on_land = (height >= Real(plate.land)) & (h > -shoulder);
  if (simd::all(on_land)) return {h, {zero, zero, up}};

  // s > 0 above the plate
  const Real half_edge(plate.opening.half_edge);
  const Real beyond = third.across - clamp(third.across, -half_edge, half_edge);
  const Mask<Real> outside = height > zero;
  const Real distance = select(outside, sqrt(fuse(height, height, beyond * beyond)), height);
  const Real out = select(outside, height / distance, one), across = select(outside, beyond / distance, zero);
  const Real s = distance - Real(plate.offset);

  // rounded quadrant {s > 0, h < 0}: measured from the centre line of the shoulder at (r, -r)
  const Real p = select(on_land, zero, shoulder - s), q = h + shoulder;
  const Real r = sqrt(fuse(p, p, q * q));
  const Mask<Real> on_shoulder = (p > zero) & (q > zero), above = q >= p;
  const Real value = select(on_shoulder, r - shoulder, select(above, h, -s));
  const Real inward = select(on_shoulder, p / r, select(above, zero, one));
  const Real upward = select(on_shoulder, q / r, select(above, one, zero));
  return {value, turn_back(third, -(inward * out), -(inward * across), up * upward)};
}

template <class Lanes>
inline Distances measure(const PunchShape& punch, const Vec3& x, const Lanes&, const Mask<Real>&) {
  const Real zero(0.0), one(1.0), half_edge(punch.base.half_edge), radius(punch.radius), slant(punch.slant);
  const Real normal_out(punch.normal_out), normal_up(punch.normal_up);
  const Real edge_slant(punch.edge_slant), edge_across(punch.edge_across);
  const Third third = find_third(x);
  const Real z = x.z - radius, across = simd::abs(third.across);  // from the apex; from the middle of the face
  const Real wall = third.out - Real(punch.base.inradius);        // height above the prism's wall
  const Real face = fuse(normal_out, third.out, normal_up * z);   // and above the pyramid's face
  const Real down = fuse(normal_out, z, -(normal_up * third.out));

  // from the nearest point of the sharp body to x: along the normal, down the face and across it
  const Mask<Real> at_prism = z >= Real(punch.height);
  const Mask<Real> past_edge = fuse(slant, across, -(half_edge * down)) > zero;
  const Real t = clamp(fuse(edge_slant, down, edge_across * across), zero, Real(punch.edge_length));
  const Real height = select(at_prism, wall, face);
  const Real past_base = across - min(across, half_edge);
  const Real by_down = select(at_prism, zero, select(past_edge, fuse(-t, edge_slant, down), down - min(down, slant)));
  const Real by_across = select(at_prism, past_base, select(past_edge, fuse(-t, edge_across, across), past_base));
  const Real distance = sqrt(fuse(height, height, fuse(by_down, by_down, by_across * by_across)));

  const Mask<Real> outside = height > zero, nearer_face = face >= wall;  // inside, contact is lost anyway
  const Real out = select(at_prism, height, fuse(normal_out, height, -(normal_up * by_down)));
  const Real up = select(at_prism, zero, fuse(normal_up, height, normal_out * by_down));
  const Real aside = select(third.across < zero, -by_across, by_across);
  const Real value = select(outside, distance, max(face, wall)) - radius;
  return {value, turn_back(third, select(outside, out / distance, select(nearer_face, normal_out, one)),
                           select(outside, aside / distance, zero),
                           select(outside, up / distance, select(nearer_face, normal_up, zero)))};
}

/// Only of the lanes that are not far, for the tool may be slow.
template <class Lanes>
inline Distances measure(const AnyShape& shape, const Vec3& x, const Lanes& lanes, const Mask<Real>& is_far) {
  alignas(64) double from[3][kWidth], distance[4][kWidth] = {};
  write_lanes(from[0], x.x);
  write_lanes(from[1], x.y);
  write_lanes(from[2], x.z);
  const unsigned far = find_lanes(lanes, is_far);
  for (int l = 0; l < kWidth; ++l) {
    double d[4] = {};
    const double at[3] = {from[0][l], from[1][l], from[2][l]};
    if (l < lanes.count() && !(far >> l & 1)) shape.evaluate(shape.tool, at, d);
    for (int k = 0; k < 4; ++k) distance[k][l] = l < lanes.count() ? d[k] : distance[k][lanes.count() - 1];
  }
  return {
      read_lanes<Real>(distance[0]),
      {read_lanes<Real>(distance[1]), read_lanes<Real>(distance[2]), read_lanes<Real>(distance[3])},
  };
}

/// Sums over the points of a block.
struct BlockSums {
  using Sum = simd::Sum<Real>;
  Sums energies;
  Sum force[3], moment[3];
  bool touches = false;
  explicit BlockSums(Index begin)
      : energies(begin), force{Sum(begin), Sum(begin), Sum(begin)}, moment{Sum(begin), Sum(begin), Sum(begin)} {}
};

template <class Lanes>
inline void clear_forces(const ToolRows& p, const Lanes& lanes) {
  Quad* const out = p.force + 2 * lanes.begin();
  for (int l = 0; l < 2 * lanes.count(); ++l) out[l] = {};
}

template <class Shape, class Lanes>
inline void advance_pack(const Shape& shape, const ToolRows& p, const Lanes& lanes, BlockSums& sums) {
  const Real zero(0.0);
  const Real old_slack = lanes.load(p.slack);
  Real slack = old_slack;
  if (any(slack > zero)) {
    const Vec3 by = load<&Node::increment>(lanes, p.layer).xyz;
    const Real down = by.z - Real(p.increment);
    slack = select(slack > zero, slack - sqrt(fuse(by.x, by.x, fuse(by.y, by.y, down * down))), slack);
    if (simd::all(slack > zero)) {
      lanes.store(p.slack, slack);
      return clear_forces(p, lanes);
    }
  }
  const Mask<Real> is_far = slack > zero;  // of some lanes: they keep their gaps, whoever their neighbours are
  const Record node = load<&Node::position>(lanes, p.layer);
  const Real &h = node.w, old_gap = lanes.load(p.points.gap);
  const Distances d = measure(shape, {node.xyz.x, node.xyz.y, node.xyz.z - Real(p.z)}, lanes, is_far);
  const Real gap = select(is_far, old_gap, d.value - h);
  slack = select(is_far, slack, max(gap - Real(p.margin), zero));
  if (any(slack != old_slack)) lanes.store(p.slack, slack);  // clean cache lines stay clean
  if (!any(min(gap, old_gap) < zero)) {                      // open, and stays so
    lanes.store(p.points.gap, gap);
    lanes.store(p.points.height, h);
    return clear_forces(p, lanes);
  }
  sums.touches = true;
  const Vec3 n = load<&Node::normal>(lanes, p.layer).xyz, normal = Real(-1.0) * d.gradient;
  const Real side = select(dot(d.gradient, n) > zero, -h, h);  // of the layer's surface that faces the tool
  Vec3 slip = load<&Node::increment>(lanes, p.layer).xyz + side * load<&Node::turn>(lanes, p.layer).xyz;
  slip.z -= Real(p.increment);
  const Vec3 stick = load(lanes, p.points.stick);
  const Force force = advance_points(
      p, lanes, {gap, h, Real(1.0), zero, normal, lay_across(stick, normal, stick), slip}, old_gap, sums.energies);
  const Vec3 total = force.drag + force.pressing * d.gradient, pull = side * force.drag;
  Quad* const out = p.force + 2 * lanes.begin();
  store(lanes, out, 2, total);
  store(lanes, out + 1, 2, pull);
  const Vec3 moment = cross(node.xyz, total) + cross(n, pull);
  sums.force[0].add(lanes, total.x);
  sums.force[1].add(lanes, total.y);
  sums.force[2].add(lanes, total.z);
  sums.moment[0].add(lanes, moment.x);
  sums.moment[1].add(lanes, moment.y);
  sums.moment[2].add(lanes, moment.z);
}

template <class Shape>
ToolSums advance_along(const Shape& shape, const ToolRows& rows, Index begin, Index end) {
  BlockSums sums(begin);
  simd::for_each_pack<Real>(begin, end, [&](const auto& lanes) { advance_pack(shape, rows, lanes, sums); });
  ToolSums result;
  result.touches = sums.touches;
  sums.energies.add_to(result.energies);
  for (int d = 0; d < 3; ++d) {
    result.force[d] = sums.force[d].total();
    result.moment[d] = sums.moment[d].total();
  }
  return result;
}

ToolSums advance(const ToolShape& shape, const ToolRows& rows, Index begin, Index end) {
  switch (shape.kind) {
    case ToolShape::Kind::Plate:
      return advance_along(shape.plate, rows, begin, end);
    case ToolShape::Kind::Punch:
      return advance_along(shape.punch, rows, begin, end);
    default:
      return advance_along(shape.any, rows, begin, end);
  }
}

}  // namespace

template <>
const ToolKernels& get_tool_kernels<simd::Target>() {
  static constexpr ToolKernels kernels{advance};
  return kernels;
}

}  // namespace interply::contact
