/// A sheet: arrays of elements and their history, advanced by the J2 law.
#pragma once

#include <memory>
#include <vector>

#include "mechanics/shell_patch.hpp"
#include "solve/blocks.hpp"
#include "solve/layer_mechanics.hpp"
#include "solver_metal/j2_law.hpp"
#include "solver_metal/lobatto.hpp"
#include "solver_metal/metal_element.hpp"

namespace interply::metal {

/// Elements innermost; rows as named.
using Rows = Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Rotation-free shell (services/mechanics/shell_patch.hpp) with J2 plasticity at the points of a Lobatto rule.
/// Frame: x, y of the flat blank; J2 is isotropic, so the layer's orientation plays no part.
class MetalLayer : public solve::LayerMechanics {
 public:
  /// @param layer         law, thickness, integration points, threads; its own density is not used
  /// @param density       with mass scaling, t/mm3
  /// @pre layer.kind() == Metal
  MetalLayer(const scene::Layer& layer, double density, const mechanics::TriangleMesh& mesh);

  void compute_internal_forces(const mechanics::NodalVectors& position, double time,
                               mechanics::NodalVectors& force) override;
  double internal_energy() const override { return internal_energy_; }
  double compute_stable_increment() override;
  mechanics::Scalars compute_nodal_thickness() const override;
  std::vector<observe::Field> compute_fields() const override;
  std::vector<exchange::SummaryItem> summarise() const override;
  void add_state_to(mechanics::Digest& digest) const override;

 private:
  /// What went wrong in a block: its first bad element and that element's area ratio.
  struct BadElement {
    Eigen::Index element = -1;
    double area_ratio = 0;
  };

  /// g_k g_k' of the three corners, g_k = U^-1 dN_k/dX (1/mm), and the current volume, mm3.
  struct CornerGradients {
    Symmetric2 product[3];
    double volume = 0;
  };

  Eigen::Index n_elements() const { return patches_.n_elements(); }
  J2Point load_point(int i, Eigen::Index e) const;
  void store_point(int i, Eigen::Index e, const J2Point& point);
  /// Elements [begin, end): strain, stress, thickness and element forces. Returns their stress work, mJ.
  double advance_elements(const mechanics::NodalVectors& position, Eigen::Index begin, Eigen::Index end,
                          BadElement& bad);
  /// Stress, thickness and resultants of one element; adds its stress work to `work`.
  Resultants advance_element(Eigen::Index e, const ElementShape& now, double& work);
  void add_element_forces(Eigen::Index e, const mechanics::SurfaceGradient& g, const mechanics::Curvature& curvature,
                          const Resultants& r);
  CornerGradients compute_corner_gradients(Eigen::Index e) const;
  [[noreturn]] void report(const BadElement& bad, const mechanics::NodalVectors& position, double time) const;

  std::string name_;
  J2Constants law_;
  ThicknessRule rule_;
  double thickness0_;  // mm
  mechanics::ShellPatches patches_;
  mechanics::Scalars mass_;                // lumped, with mass scaling [n_nodes] t
  mechanics::Scalars bending_compliance_;  // [n_el], see stable_increment.hpp

  // state after the last compute_internal_forces()
  Rows metric_;                   // C11, C22, C12                          [3 x n_el]
  Rows curvature_;                // kappa11, kappa22, kappa12              [3 x n_el]          1/mm
  Rows stress_;                   // row 3i + (s11, s22, s12) of point i    [3 n_points x n_el] MPa
  Rows plastic_strain_;           // row i                                 [n_points x n_el]
  Rows yield_stress_;             // row i                                  [n_points x n_el]   MPa
  Rows yield_slope_;              // row i                                  [n_points x n_el]   MPa
  mechanics::Scalars thickness_;  // [n_el] mm
  double internal_energy_ = 0;    // mJ

  // scratch, sized once
  mechanics::Scalars nodal_stiffness_;  // [n_nodes] mm
  mechanics::NodalVectors slot_force_;  // force on slot s of element e in column s * n_el + e [3 x 6 n_el] N
  std::vector<double> block_work_;
  std::vector<BadElement> block_bad_;
  solve::Workers workers_;
};

/// Factory for solve::solver_main(): layer `layer` of the scene with its mass scaling.
std::unique_ptr<solve::LayerMechanics> make_metal_layer(const scene::Scene& scene, int layer,
                                                        const mechanics::TriangleMesh& mesh);

}  // namespace interply::metal
