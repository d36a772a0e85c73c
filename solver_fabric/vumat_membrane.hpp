/// A user's own law (services/solve/vumat.hpp) as the membrane of a ply: one point per element.
#pragma once

#include <string>
#include <vector>

#include "mechanics/edge_shell.hpp"
#include "solve/vumat.hpp"

namespace interply::fabric {

/// Element arrays of the membrane and their history. The reference frame is that of the ply: e1 along the warp.
class VumatMembrane {
 public:
  /// @param shell      in the frame of the ply; outlives this
  /// @param reference  nodes, mm
  /// @throws scene::SceneError as solve::VumatPoints
  VumatMembrane(const scene::Layer& layer, const mechanics::ShellGeometry& shell,
                const mechanics::NodalVectors& reference);

  /// Where the elements have gone. An instant with dt = 0 belongs to no motion: the law is called, so that the call can
  /// be timed, but neither stress nor history moves.
  /// @param f1,f2     columns of F [3 x n_el]. @pre det F'F > 0
  /// @param position  nodes, mm
  /// @return the first element whose stress or thickness is not finite, or -1
  Eigen::Index advance(const mechanics::NodalVectors& f1, const mechanics::NodalVectors& f2,
                       const mechanics::NodalVectors& position, const solve::Instant& now);

  /// S = J F33 U^-1 sigma U^-1, per reference thickness: (S11, S22, S12), MPa.
  mechanics::Vector3 stress(Eigen::Index e) const { return stress_.col(e); }
  /// Stress work per reference volume, sum of 1/2 (S_old + S_new) : dE, MPa.
  double energy(Eigen::Index e) const { return energy_(e); }
  /// Current / reference thickness at the nodes, mean of their elements.
  mechanics::Scalars compute_nodal_thickness_stretch() const;

  /// Largest over the elements of lambda_max(K_el/(A t)) in (T1) of stable_increment.hpp, MPa/mm2, by
  ///   J F33 [ lambda_max(D Q) + 3 |sigma| lambda_max(G) ],   G = sum_k g_k g_k',  g_k = U^-1 grad N_k       (T3)
  /// with D the tangent for (e11, e22, 2 e12), measured by small strains and not below that of the undeformed law;
  /// Q = B B' of the constant-strain triangle. The stress |sigma| (largest principal) enters by geometric stiffness,
  /// change of U^-1 and of the volume, as for a sheet.
  /// @throws mechanics::Divergence where the law fails
  double compute_eigenvalue_bound();

  /// Adds `thickness_stretch` and `state_1`, `state_2`, ...
  void add_fields(std::vector<observe::Field>& fields) const;
  /// "the vumat returned the stress ..."
  std::string describe_response(Eigen::Index e) const;
  double largest_stress_33() const { return points_.largest_stress_33(); }
  void add_state_to(mechanics::Digest& digest) const { points_.add_state_to(digest); }

 private:
  void set_place(Eigen::Index e, const mechanics::NodalVectors& position);
  void update_stress(Eigen::Index e, const mechanics::Matrix2& old_stretch);

  std::string name_;
  const mechanics::ShellGeometry& shell_;
  solve::VumatPoints points_;
  Eigen::Array<double, 3, Eigen::Dynamic, Eigen::RowMajor> stress_;  // S11, S22, S12 [3 x n_el] MPa
  mechanics::Scalars energy_;                                        // [n_el] MPa
  std::vector<solve::VumatIncrement> increments_;                    // of the last advance() [n_el]
  std::vector<Eigen::Matrix3d> tangents_;                            // of one call
  solve::Instant now_;
};

}  // namespace interply::fabric
