#include "solve/shell.hpp"

namespace interply::solve {

using Eigen::Index;

Shell::Shell(const mechanics::TriangleMesh& mesh, double angle, const mechanics::Plate& plate, int threads)
    : geometry_(mechanics::make_shell_geometry(mesh, angle)),
      edges_(geometry_, plate),
      passes_(geometry_),
      rows_(geometry_, passes_),
      slot_force_(mechanics::NodalVectors::Zero(3, 3 * mesh.n_elements())),
      block_energies_(static_cast<std::size_t>(count_blocks(geometry_.n_edges()))),
      kernels_(mechanics::choose_shell_pass_kernels()),
      workers_(threads) {}

void Shell::advance_edges(double dt) {
  workers_.for_each_block(geometry_.n_edges(), [&](Index, Index begin, Index end) { edges_.advance(dt, begin, end); });
}

void Shell::reflect_facets() {
  const auto n = static_cast<std::ptrdiff_t>(geometry_.images.size());
  const double* const mirror[2] = {geometry_.image_plane.data(), geometry_.image_plane.data() + n};
  kernels_.reflect_facets(rows_, geometry_.images.data(), mirror, n);
}

double Shell::compute_forces(double dt, mechanics::NodalVectors& force) {
  const Index n = n_elements(), n_nodes = static_cast<Index>(geometry_.gather.start.size()) - 1;
  double* const slot[3] = {&slot_force_(0, 0), &slot_force_(1, 0), &slot_force_(2, 0)};
  workers_.for_each_block(
      n, [&](Index, Index begin, Index end) { kernels_.compute_corner_forces(rows_, slot, begin, end); });
  workers_.for_each_block(geometry_.n_edges(), [&](Index block, Index begin, Index end) {
    block_energies_[static_cast<std::size_t>(block)] = edges_.update_torques(passes_, dt, begin, end);
  });
  mechanics::EdgeEnergies all;
  for (const mechanics::EdgeEnergies& e : block_energies_) {
    all.kinetic += e.kinetic;
    all.friction += e.friction;
  }
  force.resize(3, n_nodes);
  double* const out[3] = {&force(0, 0), &force(1, 0), &force(2, 0)};
  workers_.for_each_block(n_nodes, [&](Index, Index begin, Index end) {
    kernels_.gather_forces(geometry_.gather.start.data(), geometry_.gather.entry.data(), slot, out, begin, end);
  });
  return edges_.finish(dt, all);
}

}  // namespace interply::solve
