#include "solve/shell.hpp"

#include <algorithm>
#include <cstdlib>

namespace interply::solve {

using Eigen::Index;

Shell::Shell(const mechanics::TriangleMesh& mesh, double angle, const mechanics::Plate& plate, int threads)
    : geometry_(mechanics::make_shell_geometry(mesh, angle)),
      edges_(geometry_, plate),
      passes_(geometry_),
      rows_(geometry_, passes_),
      slot_force_(mechanics::NodalVectors::Zero(3, 3 * mesh.n_elements())),
      block_energies_(static_cast<std::size_t>(count_blocks(geometry_.n_edges()))),
      bad_(n_blocks()),
      one_thread_(threads == 1),
      kernels_(mechanics::choose_shell_pass_kernels()),
      workers_(threads) {
  const Index n = n_elements();
  for (Index e = 0; e < n; ++e)
    for (int k = 0; k < 3; ++k)
      if (const Index other = geometry_.neighbour(k, e); other >= 0)
        lag_ = std::max(lag_, std::abs(e / kBlockSize - other / kBlockSize));
  // images are numbered by element
  std::ptrdiff_t image = 0;
  const auto n_images = static_cast<std::ptrdiff_t>(geometry_.images.size());
  for (Index block = 0; block <= count_blocks(n); ++block) {
    while (image < n_images && geometry_.images[static_cast<std::size_t>(image)] % n < block * kBlockSize) ++image;
    first_image_.push_back(image);
  }
}

Shell::Range Shell::find_range(Index block) const {
  return {block * kBlockSize, std::min(n_elements(), (block + 1) * kBlockSize)};
}

void Shell::advance_edges(double dt) {
  workers_.for_each_block(geometry_.n_edges(), [&](Index, Index begin, Index end) { edges_.advance(dt, begin, end); });
}

void Shell::reflect_facets(Index block) {
  const auto all = static_cast<std::ptrdiff_t>(geometry_.images.size());
  const double* const mirror[2] = {geometry_.image_plane.data(), geometry_.image_plane.data() + all};
  kernels_.reflect_facets(rows_, geometry_.images.data(), mirror, first_image_[static_cast<std::size_t>(block)],
                          first_image_[static_cast<std::size_t>(block) + 1]);
}

void Shell::compute_corner_forces(Index begin, Index end) {
  double* const slot[3] = {&slot_force_(0, 0), &slot_force_(1, 0), &slot_force_(2, 0)};
  kernels_.compute_corner_forces(rows_, slot, begin, end);
}

Index Shell::run_passes(const FirstPass& facets, const Workers::Body& resultants) {
  constexpr Index kMostLag = 4;  // some 3 MB of what the passes hand on
  return one_thread_ && lag_ <= kMostLag ? trail(facets, resultants) : sweep(facets, resultants);
}

Index Shell::sweep(const FirstPass& facets, const Workers::Body& resultants) {
  for_each_block([&](Index block, Index begin, Index end) {
    bad_[static_cast<std::size_t>(block)] = facets(block, begin, end);
    reflect_facets(block);
  });
  for (const Index bad : bad_)
    if (bad >= 0) return bad;
  for_each_block(resultants);
  for_each_block([&](Index, Index begin, Index end) { compute_corner_forces(begin, end); });
  return -1;
}

Index Shell::trail(const FirstPass& facets, const Workers::Body& resultants) {
  const Index n = count_blocks(n_elements());
  const auto is_block = [&](Index block) { return block >= 0 && block < n; };
  for (Index first = 0; first < n + 2 * lag_; ++first) {
    if (is_block(first)) {
      const Range r = find_range(first);
      if (const Index bad = facets(first, r.begin, r.end); bad >= 0) return bad;
      reflect_facets(first);
    }
    if (const Index second = first - lag_; is_block(second)) {
      const Range r = find_range(second);
      resultants(second, r.begin, r.end);
    }
    if (const Index third = first - 2 * lag_; is_block(third)) {
      const Range r = find_range(third);
      compute_corner_forces(r.begin, r.end);
    }
  }
  return -1;
}

double Shell::compute_forces(double dt, mechanics::NodalVectors& force) {
  const Index n_nodes = static_cast<Index>(geometry_.gather.start.size()) - 1;
  double* const slot[3] = {&slot_force_(0, 0), &slot_force_(1, 0), &slot_force_(2, 0)};
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
