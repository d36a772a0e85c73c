/// The contact law of one point: penalty pressure, damping, Coulomb friction with elastic stick
/// (services/contact/THEORY.md).
#pragma once

#include <cmath>
#include <utility>
#include <vector>

#include "contact/law.hpp"
#include "mechanics/nodal.hpp"

namespace interply::contact {

using mechanics::NodalVectors;
using mechanics::Scalars;
using mechanics::Vector3;

/// Stiffness from the penetration that is allowed at a reference pressure, k = p_ref / (fraction * thickness).
double compute_stiffness(double reference_pressure, double fraction, double thickness);

/// c = 2 zeta sqrt(k mu*), mu* the reduced mass per area of the two partners, 1/mu* = 1/mu_1 + 1/mu_2.
/// @param fraction           zeta, of critical
/// @param mass_per_area      t/mm2; pass infinity for a rigid partner
double compute_damping(double fraction, double stiffness, double mass_per_area_1, double mass_per_area_2);

/// What friction at a distance from the midsurface adds to the largest eigenvalue of a contact spring: a normal that
/// turns moves the point where it acts, so displacements w across the layer enter the slip as offset x dw/dx. With
/// e = offset/h_el the largest eigenvalue of [1, e; e, 1 + e^2] is (e/2 + sqrt(1 + e^2/4))^2.                     (C5)
/// @param offset  of the common point from the midsurface, mm    @param area  tributary, h_el^2, mm2
inline double compute_turning_factor(double offset, double area) {
  const double half = 0.5 * offset / std::sqrt(area), root = half + std::sqrt(1 + half * half);
  return root * root;
}

/// Sum of the absolute values in a row of M^-1 K and of M^-1 C: what contact adds to the square of a frequency and to
/// its decay at most.
struct RowSum {
  double stiffness = 0;  ///< 1/s2
  double damping = 0;    ///< 1/s
};

/// Row sums at the nodes of a layer; of the three directions the largest.
struct Rates {
  Scalars stiffness, damping;  ///< as in RowSum [n_nodes]
  explicit Rates(Eigen::Index n_nodes) : stiffness(Scalars::Zero(n_nodes)), damping(Scalars::Zero(n_nodes)) {}
  Rates& operator+=(const Rates& other) {
    stiffness += other.stiffness;
    damping += other.damping;
    return *this;
  }
  RowSum find_largest() const { return {stiffness.maxCoeff(), damping.maxCoeff()}; }
};

/// All contact points of one interface; one point per facing node. The traction of a point acts on its node, the
/// partner receives the opposite. Pressure and springs are those of the part of the node's area that faces the partner.
struct Points {
  Scalars area;          ///< A   tributary area, reference                               [n]      mm2
  Scalars gap;           ///< g   along the normal, > 0 open                              [n]      mm
  Scalars weight;        ///< share of the area that still faces the partner, 1 inside    [n]
  Scalars pressure;      ///< p   with damping, >= 0                                      [n]      MPa
  NodalVectors stick;    ///< e   elastic tangential displacement of node against partner [3 x n]  mm
  Scalars slip;          ///< accumulated plastic slip where something acts               [n]      mm
  Scalars friction_work;  ///< dissipated by slip since the start, per area A              [n]      mJ/mm2
  Scalars height;        ///< sum of the half thicknesses between the midsurfaces         [n]      mm
  Eigen::ArrayXi state;  ///< State                                                       [n]

  double tangential = 0;  ///< k_t                                                                  N/mm3

  /// @param tangential_stiffness  k_t, N/mm3
  Points(const Scalars& areas, double tangential_stiffness);
  Points() = default;
  Eigen::Index size() const { return area.size(); }

  // What acts on a node, per reference area of all of it: nothing where it does not face the partner.
  Scalars acting_pressure() const { return weight * pressure; }  ///< s p  [n] MPa
  NodalVectors acting_traction() const;                          ///< tau = -s k_t e  [3 x n] MPa
};

/// What a point sees in one step. The normal points from the node to its partner.
struct PointMotion {
  double distance = 0;  ///< midsurface to midsurface (or tool) along the normal, mm
  double height = 0;    ///< distance at which they touch, mm
  double weight = 1;
  Vector3 normal;  ///< unit; the direction of the damper, and friction acts across it
  Vector3 stick;   ///< e(n - 1), carried along with the partner, mm
  Vector3 slip;    ///< displacement increment of the node's side against its partner's at their common point, mm
  double dt = 0;   ///< s; 0 at the start of a run
};

/// What a point gives.
struct PointForce {
  double pressing = 0;             ///< k A max(-g, 0): minus the derivative of the penalty energy by the gap, N
  Vector3 drag = Vector3::Zero();  ///< of friction and damper on the node's side, acts at the common point, N
};

/// A point that was open and stays so has nothing to compute but its gap.
inline bool stays_open(Points& points, Eigen::Index i, double gap, double height, double weight) {
  if (gap < 0 || points.pressure(i) != 0 || points.state(i) != static_cast<int>(State::Open)) return false;
  points.gap(i) = gap;
  points.height(i) = height;
  points.weight(i) = weight;
  return true;
}

/// Advances point `i`. Adds to friction, damping, thinning, edge and stored.
/// Return mapping: trial e + slip_t; |k_t e| <= mu p, or e is scaled back and the rest slides. Friction dissipates
/// 1/2 (tau_n + tau_n+1) . slide, which together with 1/2 k_t e^2 is exactly the trapezoid work of the traction.
/// @pre not stays_open()
inline PointForce advance_point(const InterfaceLaw& law, Points& points, Eigen::Index i, const PointMotion& m,
                                InterfaceEnergies& energies) {
  const double old_weight = points.weight(i);
  const double old_elastic = points.gap(i) < 0 ? -law.stiffness * points.gap(i) : 0.0;
  const double old_damping = points.pressure(i) - old_elastic;
  const Vector3 old_traction = -law.tangential * mechanics::at(points.stick, i);
  const double gap = m.distance - m.height;
  const double closing = m.slip.dot(m.normal);
  double elastic = 0, pressure = 0;
  if (gap < 0) {
    elastic = -law.stiffness * gap;
    const double damped = m.dt > 0 ? elastic + law.damping * closing / m.dt : elastic;
    pressure = damped > 0 ? damped : 0.0;
  }
  // friction
  Vector3 start = m.stick - m.stick.dot(m.normal) * m.normal;
  const double turned = start.squaredNorm();
  if (turned > 0)  // the spring turns with the surface and keeps its length
    start *= std::sqrt(mechanics::at(points.stick, i).squaredNorm() / turned);
  const Vector3 trial = start + m.slip - closing * m.normal;
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
  const double work = -(old_weight * old_traction + m.weight * traction).dot(slide);  // twice, per area
  energies.friction += both * work;
  energies.damping += both * (old_weight * old_damping + m.weight * (pressure - elastic)) * closing;
  energies.thinning += both * (old_weight * old_elastic + m.weight * elastic) * (m.height - points.height(i));
  energies.edge += both * law.tangential * (m.weight - old_weight) * start.dot(stick);
  energies.stored += m.weight * area *
                     (0.5 * (gap < 0 ? law.stiffness * gap * gap : 0.0) + 0.5 * law.tangential * stick.squaredNorm());

  points.gap(i) = gap;
  points.weight(i) = m.weight;
  points.height(i) = m.height;
  points.pressure(i) = pressure;
  points.friction_work(i) += 0.5 * work;
  if (old_weight > 0 || m.weight > 0) points.slip(i) += slide.norm();
  points.state(i) = static_cast<int>(state);
  for (int d = 0; d < 3; ++d) points.stick(d, i) = stick(d);
  return {.pressing = m.weight * area * elastic,
          .drag = m.weight * area * (traction - (pressure - elastic) * m.normal)};
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
