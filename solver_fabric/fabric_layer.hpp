/// One ply: membrane and bending elements over its mesh.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "mechanics/shell_patch.hpp"
#include "solve/blocks.hpp"
#include "solve/layer_mechanics.hpp"
#include "solver_fabric/membrane.hpp"

namespace interply::fabric {

/// Beyond these an element counts as folded (solver_fabric/THEORY.md: gamma -> 90 deg is an error, not a NaN).
inline constexpr double kFoldedCosine = 0.08715574274765817;  ///< cos 85 deg
inline constexpr double kFoldedAreaRatio = 0.02;              ///< current / reference area

/// Woven ply with decoupled membrane and bending (solver_fabric/THEORY.md). Bending is orthotropic in the reference
/// fibre frame,
///   m11 = D_a kappa11,  m22 = D_b kappa22,  m12 = twist 2 kappa12,
/// on the rotation-free patches of mechanics/shell_patch.hpp. Hyperelastic, so the only state is the last position.
class FabricLayer final : public solve::LayerMechanics {
 public:
  /// @param mass_scaling  factor on the density
  FabricLayer(const scene::Layer& layer, double mass_scaling, const mechanics::TriangleMesh& mesh);

  void compute_internal_forces(const mechanics::NodalVectors& position, double time,
                               mechanics::NodalVectors& force) override;
  double internal_energy() const override { return energy_; }
  double compute_stable_increment() override;
  std::vector<observe::Field> compute_fields() const override;
  std::vector<exchange::SummaryItem> summarise() const override;
  void add_state_to(mechanics::Digest&) const override {}  // no history

 private:
  template <typename Law>
  void compute_block(const Law& law, const mechanics::NodalVectors& x, Eigen::Index block, Eigen::Index begin,
                     Eigen::Index end);
  [[noreturn]] void throw_divergence(Eigen::Index e, const mechanics::NodalVectors& x, double time) const;
  FibreState fibre_state(Eigen::Index e) const;
  Potential potential(Eigen::Index e) const;

  // constant
  std::string name_;
  double thickness_;     ///< mm
  double density_;       ///< with mass scaling, t/mm3
  scene::Pair bending_;  ///< N mm
  double twist_;         ///< N mm
  MembraneLaw law_;
  mechanics::ShellPatches patches_;  ///< in the fibre frame
  double bending_frequency_bound_;   ///< squared, 1/s2

  // filled by compute_internal_forces()
  mechanics::Scalars la_, lb_;          ///< fibre stretches                        [n_el]  -
  mechanics::Scalars gamma_;            ///< shear angle                            [n_el]  rad
  mechanics::NodalVectors slot_force_;  ///< force of slot k of element e at column k n_el + e  [3 x 6 n_el]  N
  std::vector<double> block_energy_;    ///< membrane and bending energy            [blocks]  mJ
  std::vector<Eigen::Index> failed_;    ///< first unusable element of a block or -1 [blocks]
  double energy_ = 0;                   ///< mJ

  solve::Workers workers_;
};

/// Mechanics of layer `layer` of a scene. @pre the layer is a fabric
std::unique_ptr<solve::LayerMechanics> make_fabric_layer(const scene::Scene& scene, int layer,
                                                         const mechanics::TriangleMesh& mesh);

}  // namespace interply::fabric
