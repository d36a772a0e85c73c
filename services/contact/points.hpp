/// The contact law of one point: penalty pressure, damping, Coulomb friction with elastic stick
/// (services/contact/THEORY.md).
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "mechanics/nodal.hpp"

namespace interply::contact {

using mechanics::NodalVectors;
using mechanics::Scalars;
using mechanics::Vector3;

/// Everything per area of the interface, so that a result does not change with the mesh.
struct InterfaceLaw {
  double stiffness = 0;   ///< k    pressure per penetration                     N/mm3
  double tangential = 0;  ///< k_t  tangential traction per elastic slip         N/mm3
  double damping = 0;     ///< c    pressure per closing speed, while touching   N s/mm3
  double friction = 0;    ///< mu
};

/// Stiffness from the penetration that is allowed at a reference pressure, k = p_ref / (fraction * thickness).
double compute_stiffness(double reference_pressure, double fraction, double thickness);

/// c = 2 zeta sqrt(k mu*), mu* the reduced mass per area of the two partners, 1/mu* = 1/mu_1 + 1/mu_2.
/// @param fraction           zeta, of critical
/// @param mass_per_area      t/mm2; pass infinity for a rigid partner
double compute_damping(double fraction, double stiffness, double mass_per_area_1, double mass_per_area_2);

enum class State : int { Open = 0, Stick = 1, Slide = 2 };

/// All contact points of one interface; one point per facing node. The traction of a point acts on its node, the
/// partner receives the opposite.
struct Points {
  Scalars area;           ///< A   tributary area, reference                               [n]      mm2
  Scalars gap;            ///< g   along the normal, > 0 open                              [n]      mm
  Scalars weight;         ///< share of the area that still faces the partner, 1 inside    [n]
  Scalars pressure;       ///< p   with damping, >= 0                                      [n]      MPa
  Scalars damping;        ///< p - k max(-g, 0)                                            [n]      MPa
  NodalVectors stick;     ///< e   elastic tangential displacement of node against partner [3 x n]  mm
  NodalVectors traction;  ///< tau on the node, -k_t e                                     [3 x n]  MPa
  Scalars slip;           ///< accumulated plastic slip                                    [n]      mm
  Scalars height;         ///< sum of the half thicknesses between the midsurfaces         [n]      mm
  Eigen::ArrayXi state;   ///< State                                                       [n]

  explicit Points(const Scalars& areas);
  Points() = default;
  Eigen::Index size() const { return area.size(); }
};

/// Energies of one interface since the start, mJ; each accumulated from its own quantities.
struct InterfaceEnergies {
  double stored = 0;    ///< penalty and stick springs, a state function
  double friction = 0;  ///< dissipated by slip
  double damping = 0;   ///< dissipated by contact damping
  double thinning = 0;  ///< put in by growing (> 0) or thinning (< 0) layers
  double work = 0;      ///< done by the contact forces on both partners, trapezoid over their displacement increments

  /// What the books do not explain; zero for a perfect balance.
  double residual() const { return stored + friction + damping - thinning + work; }
};

/// What a point sees in one step. The normal points from the node to its partner.
struct PointMotion {
  double distance = 0;  ///< midsurface to midsurface (or tool) along the normal, mm
  double height = 0;    ///< distance at which they touch, mm
  double weight = 1;
  Vector3 normal;  ///< unit; the direction of the damper, and friction acts across it
  Vector3 push;    ///< gradient of the distance by the partner's place: the penalty pushes along it, push.n = 1
  Vector3 slip;    ///< displacement increment of the node against its partner, mm
  double dt = 0;   ///< s; 0 at the start of a run
};

/// Advances point `i` and returns the force on its node, N. Adds to friction, damping, thinning and stored.
/// Return mapping: trial e + slip_t; |k_t e| <= mu p, or e is scaled back and the rest slides. Friction dissipates
/// 1/2 (tau_n + tau_n+1) . slide, which together with 1/2 k_t e^2 is exactly the trapezoid work of the traction.
inline Vector3 advance_point(const InterfaceLaw& law, Points& points, Eigen::Index i, const PointMotion& m,
                             InterfaceEnergies& energies) {
  const double old_pressure = points.pressure(i), old_damping = points.damping(i);
  const double old_weight = points.weight(i);
  const double gap = m.distance - m.height;
  const double closing = m.slip.dot(m.normal);
  double elastic = 0, pressure = 0;
  if (gap < 0) {
    elastic = -law.stiffness * gap;
    const double damped = m.dt > 0 ? elastic + law.damping * closing / m.dt : elastic;
    pressure = damped > 0 ? damped : 0.0;
  } else if (old_pressure == 0 && points.state(i) == static_cast<int>(State::Open)) {
    points.gap(i) = gap;  // was open, stays open
    points.height(i) = m.height;
    points.weight(i) = m.weight;
    return Vector3::Zero();
  }
  // friction
  const Vector3 old_stick = mechanics::at(points.stick, i);
  Vector3 trial = old_stick - old_stick.dot(m.normal) * m.normal;
  const double turned = trial.squaredNorm();
  if (turned > 0) trial *= std::sqrt(old_stick.squaredNorm() / turned);  // the spring turns with the surface
  trial += m.slip - closing * m.normal;
  const double limit = law.friction * pressure;
  const double trial_traction = law.tangential * trial.norm();
  Vector3 stick = trial;
  State state = gap < 0 ? State::Stick : State::Open;
  if (trial_traction > limit) {
    stick *= trial_traction > 0 ? limit / trial_traction : 0.0;
    if (gap < 0) state = State::Slide;
  }
  const Vector3 slide = trial - stick;
  const Vector3 traction = -law.tangential * stick;
  const double area = points.area(i);
  const double both = 0.5 * area;
  energies.friction -= both * (old_weight * mechanics::at(points.traction, i) + m.weight * traction).dot(slide);
  energies.damping += both * (old_weight * old_damping + m.weight * (pressure - elastic)) * closing;
  energies.thinning +=
      both * (old_weight * (old_pressure - old_damping) + m.weight * elastic) * (m.height - points.height(i));
  energies.stored += m.weight * area *
                     (0.5 * (gap < 0 ? law.stiffness * gap * gap : 0.0) + 0.5 * law.tangential * stick.squaredNorm());

  points.gap(i) = gap;
  points.weight(i) = m.weight;
  points.height(i) = m.height;
  points.pressure(i) = pressure;
  points.damping(i) = pressure - elastic;
  points.slip(i) += slide.norm();
  points.state(i) = static_cast<int>(state);
  for (int d = 0; d < 3; ++d) {
    points.stick(d, i) = stick(d);
    points.traction(d, i) = traction(d);
  }
  return m.weight * area * (traction - elastic * m.push - (pressure - elastic) * m.normal);
}

/// Elastic part of the normal force of point `i`, N: the derivative of its penalty energy by the distance.
inline double elastic_force(const Points& points, Eigen::Index i) {
  return points.weight(i) * points.area(i) * (points.pressure(i) - points.damping(i));
}

/// Penetrations of all touching points of several interfaces, relative to a thickness, with their areas.
class PenetrationSample {
 public:
  /// Adds the points that touch, with their share of area that still faces the partner. @param thickness  mm
  void add(const Points& points, double thickness);
  /// Penetration / thickness that `fraction` of the touching area stays below; 0 if nothing touches.
  double compute_percentile(double fraction);
  double peak() const { return peak_; }  ///< largest penetration / thickness

 private:
  std::vector<std::pair<double, double>> depth_and_area_;
  double peak_ = 0;
};

}  // namespace interply::contact
