/// One ply: membrane and bending elements over its mesh.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "solve/layer_mechanics.hpp"
#include "solve/shell.hpp"
#include "solver_fabric/fabric_kernels.hpp"
#include "solver_fabric/material_point.hpp"
#include "solver_fabric/membrane_law.hpp"
#include "solver_fabric/vumat_membrane.hpp"

namespace interply::fabric {

/// Woven ply with decoupled membrane and bending (solver_fabric/THEORY.md). Bending is orthotropic in the reference
/// fibre frame,
///   m11 = D_a kappa11,  m22 = D_b kappa22,  m12 = twist 2 kappa12,
/// on the triangles of mechanics/edge_shell.hpp, whose edge rotations are the only state beside the position. A user's
/// own law may take the place of the woven membrane, and then has its history.
class FabricLayer final : public solve::LayerMechanics {
 public:
  /// @param mass_scaling  factor on the density
  FabricLayer(const scene::Layer& layer, double mass_scaling, const mechanics::TriangleMesh& mesh);

  void compute_internal_forces(const mechanics::NodalVectors& position, const solve::Instant& now,
                               mechanics::NodalVectors& force) override;
  double internal_energy() const override { return energy_ + edge_energy_; }
  double compute_stable_increment(const mechanics::NodalVectors& position) override;
  mechanics::Scalars compute_nodal_thickness() const override;
  std::vector<observe::Field> compute_fields(const mechanics::NodalVectors& position) const override;
  std::vector<solve::TrustLimit> trust_limits() const override;
  Eigen::ArrayXXd compute_trust_quantities(const mechanics::NodalVectors& position) const override;
  std::vector<exchange::SummaryItem> summarise(const mechanics::NodalVectors& position) const override;
  void add_state_to(mechanics::Digest& digest) const override;

 private:
  /// First pass of the user's own law, which wants the whole layer from one thread.
  void stretch_own_law(const mechanics::NodalVectors& x, const solve::Instant& now);
  [[noreturn]] void throw_divergence(Eigen::Index e, const mechanics::NodalVectors& x, double time) const;
  /// Deformation and response of an element; `smallest_eigenvalue` is of the woven laws alone.
  FabricPoint evaluate_element(const mechanics::NodalVectors& x, Eigen::Index e) const;
  void add_fibre_directions(const mechanics::NodalVectors& x, std::vector<observe::Field>& fields) const;

  // constant
  std::string name_;
  double thickness_;  ///< mm
  double density_;    ///< with mass scaling, t/mm3
  BendingStiffness bending_;
  std::optional<MembraneLaw> law_;  ///< woven; absent with an own law
  double bending_frequency2_;       ///< bound of the bending alone, 1/s2
  const FabricKernels& kernels_;

  solve::Shell shell_;                           ///< in the fibre frame
  std::unique_ptr<VumatMembrane> own_;           ///< the user's law and its history, or null
  std::vector<MembraneResult> stretch_results_;  ///< [blocks]
  std::vector<double> block_energy_;             ///< of bending [blocks] mJ
  double own_energy_ = 0;                        ///< of a user's own membrane, mJ
  double energy_ = 0;                            ///< of membrane and bending, mJ
  double edge_energy_ = 0;                       ///< of the edges and their damping, mJ
};

/// Mechanics of layer `layer` of a scene. @pre the layer is a fabric
std::unique_ptr<solve::LayerMechanics> make_fabric_layer(const scene::Scene& scene, int layer,
                                                         const mechanics::TriangleMesh& mesh);

}  // namespace interply::fabric
