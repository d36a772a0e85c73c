/// A user's own law (services/solve/vumat.hpp) at the points through the thickness of a sheet.
#pragma once

#include <vector>

#include "mechanics/mesh.hpp"
#include "solve/vumat.hpp"
#include "solver_metal/lobatto.hpp"
#include "solver_metal/metal_element.hpp"

namespace interply::metal {

/// Elements are called together, section point by section point from the bottom. The reference frame has e1 along the
/// rolling direction. A point at height z gets the strain increment of the shell (E1), and as stretch
/// U = sqrt(C - 2 z kappa).
class VumatSection {
 public:
  /// @throws scene::SceneError as solve::VumatPoints
  VumatSection(const scene::Layer& layer, const ThicknessRule& rule, const mechanics::TriangleMesh& mesh);

  /// Before the elements of one evaluation. An instant with dt = 0 belongs to no motion: the law is called, but nothing
  /// moves.
  void begin(const mechanics::NodalVectors& position, const solve::Instant& now);
  bool is_still() const { return now_.dt == 0; }

  /// What element e does next at all its points. @param thickness  before, mm
  void set_increment(Eigen::Index e, const ElementShape& now, const StrainIncrement& de, double thickness);
  /// Advances all points of the elements [begin, end), at most kVumatBlock, by that.
  void advance(Eigen::Index begin, Eigen::Index end);
  /// Hands over the stress of point i of element e, MPa.
  /// @return its thickness strain increment in the last advance(); not finite if the law failed
  double take(Eigen::Index e, int i, Symmetric2& stress) const;

  /// d sigma / d(e11, e22, 2 e12) of the undeformed law, MPa.
  const Eigen::Matrix3d& initial_tangent() const { return points_.initial_tangent(); }
  /// Modulus E of the isotropic material with nu = 0 that is nowhere softer than the law now, nor than the undeformed
  /// law: lambda_max(T D T), T = diag(1, 1, sqrt 2), MPa.
  /// @throws mechanics::Divergence where the law fails
  double compute_modulus_bound();
  double initial_modulus_bound() const;

  /// Adds state_1, state_2, ... at the midsurface.
  void add_fields(std::vector<observe::Field>& fields) const;
  double largest_stress_33() const { return points_.largest_stress_33(); }
  void add_state_to(mechanics::Digest& digest) const { points_.add_state_to(digest); }

 private:
  Eigen::Index point(Eigen::Index e, int i) const { return i * area_.size() + e; }

  std::string name_;
  ThicknessRule rule_;
  mechanics::Triangles nodes_;  // [3 x n_el]
  mechanics::Scalars area_;     // reference [n_el] mm2
  solve::VumatPoints points_;
  std::vector<solve::VumatIncrement> increments_;  // of the last evaluation [n_points x n_el]
  std::vector<double> old_thickness_;              // F33 before it [n_points x n_el]
  solve::Instant now_;
};

}  // namespace interply::metal
