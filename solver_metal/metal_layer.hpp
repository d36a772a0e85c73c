/// A sheet: arrays of elements and their history, advanced by the J2 law.
#pragma once

#include <memory>
#include <vector>

#include "solve/layer_mechanics.hpp"
#include "solve/shell.hpp"
#include "solver_metal/law_constants.hpp"
#include "solver_metal/lobatto.hpp"
#include "solver_metal/metal_element.hpp"
#include "solver_metal/metal_kernels.hpp"
#include "solver_metal/vumat_section.hpp"

namespace interply::metal {

/// Elements innermost; rows as named.
using Rows = Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Shell of edge rotations (services/mechanics/edge_shell.hpp) with J2 or Hill48 plasticity, or a user's own law,
/// at the points of a Lobatto rule. Reference frame: x, y of the flat blank; with Hill48 or an own law the rolling
/// direction, at the layer's orientation from x, and across it.
class MetalLayer : public solve::LayerMechanics {
 public:
  /// @param layer         law, thickness, integration points, threads; its own density is not used
  /// @param density       with mass scaling, t/mm3
  /// @pre layer.kind() == Metal
  MetalLayer(const scene::Layer& layer, double density, const mechanics::TriangleMesh& mesh);

  void compute_internal_forces(const mechanics::NodalVectors& position, const solve::Instant& now,
                               mechanics::NodalVectors& force) override;
  double internal_energy() const override { return internal_energy_; }
  double compute_stable_increment(const mechanics::NodalVectors& position) override;
  mechanics::Scalars compute_nodal_thickness() const override;
  std::vector<observe::Field> compute_fields(const mechanics::NodalVectors& position) const override;
  std::vector<solve::TrustLimit> trust_limits() const override;
  Eigen::ArrayXXd compute_trust_quantities(const mechanics::NodalVectors& position) const override;
  std::vector<exchange::SummaryItem> summarise(const mechanics::NodalVectors& position) const override;
  void add_state_to(mechanics::Digest& digest) const override;

 private:
  Eigen::Index n_elements() const { return shell_.n_elements(); }
  SheetRows make_rows();
  Symmetric2 load_stress(int i, Eigen::Index e) const;
  /// Second pass of an own law; as SheetAdvance of metal_kernels.hpp.
  SheetAdvance advance_own(Eigen::Index begin, Eigen::Index end);
  /// One element's way through advance_own().
  struct OwnStep {
    ElementShape now;
    double area_ratio_before = 1;
    StrainIncrement strain;
  };
  /// Stress, thickness and resultants of an element whose points have advanced; adds its stress work to `work`.
  Resultants take_own_element(Eigen::Index e, const OwnStep& step, double& work);
  /// @throws mechanics::Divergence  says why element `e` cannot go on
  [[noreturn]] void report(Eigen::Index e, const mechanics::NodalVectors& position, double time) const;

  std::string name_;
  LawConstants law_;
  ThicknessRule rule_;
  double thickness0_;                  // mm
  std::unique_ptr<VumatSection> own_;  // the user's law and its history, or null
  mechanics::Scalars mass_;            // lumped, with mass scaling [n_nodes] t
  solve::Shell shell_;
  mechanics::Scalars bending_frequency2_;  // of the flat elastic sheet [n_el] 1/s2

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
  mechanics::Scalars nodal_stiffness_;  // q_k/m_k of (T2) [n_nodes] mm/t
  SheetRows rows_;                      // of the state
  std::vector<SheetAdvance> blocks_;    // of elements
  const MetalKernels& kernels_;
};

/// Factory for solve::solver_main(): layer `layer` of the scene with its mass scaling.
std::unique_ptr<solve::LayerMechanics> make_metal_layer(const scene::Scene& scene, int layer,
                                                        const mechanics::TriangleMesh& mesh);

}  // namespace interply::metal
