/// One evaluation of a layer's shell (mechanics/edge_shell.hpp) on its worker threads. A solver adds its law:
///
///   shell.compute_forces(dt, facets, resultants, force);
///
/// moves the edges, phi(n - 1) -> phi(n), lets the kernels of the solver store facets, then moments and membrane
/// forces, and sums the corner forces over the nodes and the torques over the edges.
///
/// One thread runs all of that a few blocks behind each other (trail.hpp) in a single sweep: constants, state, edges
/// and nodes pass through the cache once, and what the passes hand on never leaves it. Threads run pass after pass.
#pragma once

#include <functional>
#include <vector>

#include "mechanics/edge_motion.hpp"
#include "solve/blocks.hpp"
#include "solve/trail.hpp"

namespace interply::solve {

/// Whether the passes of one thread keep all elements, for a law that is not made of kernels, or only their rings.
enum class Keep { Rings, All };

class Shell {
 public:
  /// @param angle  of the reference frame from x, rad      @param threads  at least 1
  /// @throws std::invalid_argument for a mesh with bad triangles
  Shell(const mechanics::TriangleMesh& mesh, double angle, const mechanics::Plate& plate, int threads, Keep keep);
  Shell(const Shell&) = delete;
  Shell& operator=(const Shell&) = delete;

  const mechanics::ShellGeometry& geometry() const { return geometry_; }
  const mechanics::EdgeMotion& edges() const { return edges_; }
  /// Of the last evaluation; all elements only with Keep::All.
  mechanics::ShellPasses& passes() { return passes_; }
  const mechanics::ShellRows& rows() const { return rows_; }
  Eigen::Index n_elements() const { return geometry_.n_elements(); }
  std::size_t n_blocks() const { return static_cast<std::size_t>(trail_.n_blocks); }

  /// Body over the blocks of elements (blocks.hpp).
  void for_each_block(const Workers::Body& body) { workers_.for_each_block(n_elements(), body); }

  /// First pass of a block; returns its first element that cannot be used, or -1.
  using FirstPass = std::function<Eigen::Index(Eigen::Index block, Eigen::Index begin, Eigen::Index end)>;
  struct Result {
    Eigen::Index bad = -1;  ///< first element that the first pass could not use; then the rest may not have run
    double energy = 0;      ///< that left the layer towards its edges in this step, mJ
  };
  /// @param resultants  second pass
  /// @param force       overwritten [3 x n_nodes] N
  Result compute_forces(double dt, const FirstPass& facets, const Workers::Body& resultants,
                        mechanics::NodalVectors& force);

 private:
  struct Range {
    Eigen::Index begin, end;
  };
  static Range find_range(Eigen::Index block, Eigen::Index n);
  void reflect_facets(Eigen::Index block);
  void update_torques(Eigen::Index block_of_edges, double dt);
  Eigen::Index sweep(double dt, const FirstPass& facets, const Workers::Body& resultants, double* const force[3]);
  Eigen::Index trail(double dt, const FirstPass& facets, const Workers::Body& resultants, double* const force[3]);

  mechanics::ShellGeometry geometry_;
  Trail trail_;
  mechanics::EdgeMotion edges_;
  mechanics::ShellPasses passes_;
  mechanics::ShellRows rows_;
  std::vector<mechanics::EdgeEnergies> block_energies_;
  std::vector<Eigen::Index> bad_;  ///< of the first pass [blocks]
  bool one_thread_;
  const mechanics::ShellPassKernels& kernels_;
  Workers workers_;
};

}  // namespace interply::solve
