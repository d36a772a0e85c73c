/// One ply: membrane and bending elements over its mesh.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "mechanics/edge_motion.hpp"
#include "solve/blocks.hpp"
#include "solve/layer_mechanics.hpp"
#include "solver_fabric/membrane.hpp"
#include "solver_fabric/vumat_membrane.hpp"

namespace interply::fabric {

/// Beyond these an element counts as folded (solver_fabric/THEORY.md: gamma -> 90 deg is an error, not a NaN).
inline constexpr double kFoldedCosine = 0.08715574274765817;  ///< cos 85 deg
inline constexpr double kFoldedAreaRatio = 0.02;              ///< current / reference area

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
  double compute_stable_increment() override;
  mechanics::Scalars compute_nodal_thickness() const override;
  std::vector<observe::Field> compute_fields() const override;
  std::vector<exchange::SummaryItem> summarise() const override;
  void add_state_to(mechanics::Digest& digest) const override;

 private:
  /// Before the first pass: stress of the user's own law, which wants the whole layer from one thread.
  void advance_own_law(const mechanics::NodalVectors& x, const solve::Instant& now);
  /// First pass: facets, and the forces of the membrane into the slots. Returns its energy, mJ.
  template <typename Law>
  double compute_membrane(const Law& law, const mechanics::NodalVectors& x, Eigen::Index begin, Eigen::Index end,
                          Eigen::Index& failed);
  /// Second pass: curvatures and moments. Returns the energy of bending, mJ.
  double compute_bending(Eigen::Index begin, Eigen::Index end);
  [[noreturn]] void throw_divergence(Eigen::Index e, const mechanics::NodalVectors& x, double time) const;
  FibreState fibre_state(Eigen::Index e) const;
  Potential potential(Eigen::Index e) const;

  // constant
  std::string name_;
  double thickness_;                ///< mm
  double density_;                  ///< with mass scaling, t/mm3
  scene::Pair bending_;             ///< N mm
  double twist_;                    ///< N mm
  std::optional<MembraneLaw> law_;  ///< woven; absent with an own law
  mechanics::ShellGeometry shell_;  ///< in the fibre frame

  std::unique_ptr<VumatMembrane> own_;  ///< the user's law and its history, or null

  // filled by compute_internal_forces()
  mechanics::Scalars la_, lb_;  ///< fibre stretches                        [n_el]  -
  mechanics::Scalars gamma_;    ///< shear angle                            [n_el]  rad
  mechanics::EdgeMotion edges_;
  mechanics::ShellPasses passes_;
  mechanics::NodalVectors slot_force_;     ///< force on corner k of element e at column k n_el + e  [3 x 3 n_el]  N
  std::vector<double> block_energy_;       ///< membrane and bending energy            [blocks]  mJ
  std::vector<double> block_edge_energy_;  ///< that left towards the edges in a step  [blocks of edges]  mJ
  std::vector<Eigen::Index> failed_;       ///< first unusable element of a block or -1 [blocks]
  double energy_ = 0;                      ///< of membrane and bending, mJ
  double edge_energy_ = 0;                 ///< of the edges and their damping, mJ
  double bending_frequency2_;              ///< bound of the bending alone, 1/s2

  solve::Workers workers_;
};

/// Mechanics of layer `layer` of a scene. @pre the layer is a fabric
std::unique_ptr<solve::LayerMechanics> make_fabric_layer(const scene::Scene& scene, int layer,
                                                         const mechanics::TriangleMesh& mesh);

}  // namespace interply::fabric
