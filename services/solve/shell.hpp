/// One evaluation of a layer's shell (mechanics/edge_shell.hpp) on its worker threads. A solver adds its law:
///
///   shell.advance_edges(dt);                          rotations of the edges, phi(n - 1) -> phi(n)
///   bad = shell.run_passes(facets, resultants);       its kernels store facets, then moments and membrane forces
///   energy += shell.compute_forces(dt, force);        torques of the edges, sum over the nodes
///
/// The passes need their neighbours' results of the pass before. Elements that are numbered row by row have them a
/// block or two away, so one thread runs the passes a few blocks behind each other, while what they hand on is still in
/// its cache.
#pragma once

#include <functional>
#include <vector>

#include "mechanics/edge_motion.hpp"
#include "solve/blocks.hpp"

namespace interply::solve {

class Shell {
 public:
  /// @param angle  of the reference frame from x, rad      @param threads  at least 1
  /// @throws std::invalid_argument for a mesh with bad triangles
  Shell(const mechanics::TriangleMesh& mesh, double angle, const mechanics::Plate& plate, int threads);
  Shell(const Shell&) = delete;
  Shell& operator=(const Shell&) = delete;

  const mechanics::ShellGeometry& geometry() const { return geometry_; }
  const mechanics::EdgeMotion& edges() const { return edges_; }
  mechanics::ShellPasses& passes() { return passes_; }
  const mechanics::ShellPasses& passes() const { return passes_; }
  const mechanics::ShellRows& rows() const { return rows_; }
  Eigen::Index n_elements() const { return geometry_.n_elements(); }
  std::size_t n_blocks() const { return static_cast<std::size_t>(count_blocks(n_elements())); }

  /// Body over the blocks of elements (blocks.hpp).
  void for_each_block(const Workers::Body& body) { workers_.for_each_block(n_elements(), body); }

  void advance_edges(double dt);
  /// First pass of a block; returns its first element that cannot be used, or -1.
  using FirstPass = std::function<Eigen::Index(Eigen::Index block, Eigen::Index begin, Eigen::Index end)>;
  /// First and second pass of the solver, and the corner forces.
  /// @return first element that cannot be used, or -1. Then later passes may not have run.
  Eigen::Index run_passes(const FirstPass& facets, const Workers::Body& resultants);
  /// @param force  overwritten [3 x n_nodes] N
  /// @return energy that left the layer towards its edges in this step, mJ
  double compute_forces(double dt, mechanics::NodalVectors& force);

 private:
  struct Range {
    Eigen::Index begin, end;
  };
  Range find_range(Eigen::Index block) const;
  void reflect_facets(Eigen::Index block);
  void compute_corner_forces(Eigen::Index begin, Eigen::Index end);
  Eigen::Index sweep(const FirstPass& facets, const Workers::Body& resultants);
  Eigen::Index trail(const FirstPass& facets, const Workers::Body& resultants);

  mechanics::ShellGeometry geometry_;
  mechanics::EdgeMotion edges_;
  mechanics::ShellPasses passes_;
  mechanics::ShellRows rows_;
  mechanics::NodalVectors slot_force_;  ///< force on corner k of element e at column k n_el + e  [3 x 3 n_el]  N
  std::vector<mechanics::EdgeEnergies> block_energies_;
  std::vector<Eigen::Index> bad_;            ///< of the first pass [blocks]
  std::vector<std::ptrdiff_t> first_image_;  ///< of the elements of a block [blocks + 1]
  Eigen::Index lag_ = 0;                     ///< blocks between an element and its farthest neighbour
  bool one_thread_;
  const mechanics::ShellPassKernels& kernels_;
  Workers workers_;
};

}  // namespace interply::solve
