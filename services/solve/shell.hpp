/// One evaluation of a layer's shell (mechanics/edge_shell.hpp) on its worker threads. A solver adds its law:
///
///   shell.advance_edges(dt);                        rotations of the edges, phi(n - 1) -> phi(n)
///   shell.for_each_block(pass 1);                   its kernel stores the facets
///   shell.reflect_facets();
///   shell.for_each_block(pass 2);                   its kernel stores moments and membrane forces
///   energy += shell.compute_forces(dt, force);      corner forces, torques of the edges, sum over the nodes
#pragma once

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
  void reflect_facets();
  /// @param force  overwritten [3 x n_nodes] N
  /// @return energy that left the layer towards its edges in this step, mJ
  double compute_forces(double dt, mechanics::NodalVectors& force);

 private:
  mechanics::ShellGeometry geometry_;
  mechanics::EdgeMotion edges_;
  mechanics::ShellPasses passes_;
  mechanics::ShellRows rows_;
  mechanics::NodalVectors slot_force_;  ///< force on corner k of element e at column k n_el + e  [3 x 3 n_el]  N
  std::vector<mechanics::EdgeEnergies> block_energies_;
  const mechanics::ShellPassKernels& kernels_;
  Workers workers_;
};

}  // namespace interply::solve
