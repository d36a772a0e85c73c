#include "solve/shell.hpp"

#include <algorithm>

namespace interply::solve {

using Eigen::Index;

namespace {

/// count[i] with 0 before the first.
Index get_before(const std::vector<Index>& count, Index i) {
  return i == 0 ? 0 : count[static_cast<std::size_t>(i) - 1];
}

}  // namespace

Shell::Shell(const mechanics::TriangleMesh& mesh, double angle, const mechanics::Plate& plate, int threads, Keep keep)
    : geometry_(mechanics::make_shell_geometry(mesh, angle)),
      trail_(make_trail(geometry_)),
      edges_(geometry_, plate),
      passes_(geometry_, threads > 1 || keep == Keep::All ? mechanics::make_whole_rings(n_elements()) : trail_.rings),
      rows_(geometry_, passes_),
      block_energies_(static_cast<std::size_t>(count_blocks(geometry_.n_edges()))),
      bad_(n_blocks()),
      one_thread_(threads == 1),
      kernels_(mechanics::choose_shell_pass_kernels()),
      workers_(threads) {}

Shell::Range Shell::find_range(Index block, Index n) {
  return {block * kBlockSize, std::min(n, (block + 1) * kBlockSize)};
}

void Shell::reflect_facets(Index block) {
  kernels_.reflect_facets(rows_, get_before(trail_.images, block), trail_.images[static_cast<std::size_t>(block)]);
}

void Shell::update_torques(Index block_of_edges, double dt) {
  const Range r = find_range(block_of_edges, geometry_.n_edges());
  block_energies_[static_cast<std::size_t>(block_of_edges)] = edges_.update_torques(rows_, dt, r.begin, r.end);
}

Shell::Result Shell::compute_forces(double dt, const FirstPass& facets, const Workers::Body& resultants,
                                    mechanics::NodalVectors& force) {
  force.resize(3, static_cast<Index>(geometry_.gather.start.size()) - 1);
  double* const out[3] = {&force(0, 0), &force(1, 0), &force(2, 0)};
  const Index bad = one_thread_ ? trail(dt, facets, resultants, out) : sweep(dt, facets, resultants, out);
  if (bad >= 0) return {.bad = bad};
  mechanics::EdgeEnergies all;
  for (const mechanics::EdgeEnergies& e : block_energies_) {
    all.kinetic += e.kinetic;
    all.friction += e.friction;
  }
  return {.energy = edges_.finish(dt, all)};
}

Index Shell::sweep(double dt, const FirstPass& facets, const Workers::Body& resultants, double* const force[3]) {
  const Index n_nodes = static_cast<Index>(geometry_.gather.start.size()) - 1;
  workers_.for_each_block(geometry_.n_edges(), [&](Index, Index begin, Index end) { edges_.advance(dt, begin, end); });
  for_each_block([&](Index block, Index begin, Index end) {
    bad_[static_cast<std::size_t>(block)] = facets(block, begin, end);
    reflect_facets(block);
  });
  for (const Index bad : bad_)
    if (bad >= 0) return bad;
  for_each_block(resultants);
  for_each_block([&](Index, Index begin, Index end) { kernels_.compute_corner_forces(rows_, begin, end); });
  workers_.for_each_block(geometry_.n_edges(), [&](Index block, Index, Index) { update_torques(block, dt); });
  workers_.for_each_block(n_nodes,
                          [&](Index, Index begin, Index end) { kernels_.gather_forces(rows_, force, begin, end); });
  return -1;
}

Index Shell::trail(double dt, const FirstPass& facets, const Workers::Body& resultants, double* const force[3]) {
  const Index n = trail_.n_blocks, lag = trail_.lag;
  const auto turn_to = [&](Index block) {
    const Range r = find_range(block, n_elements());
    rows_.turn_to(r.begin);
    return r;
  };
  for (Index latest = 0; latest < n + 2 * lag; ++latest) {
    if (latest < n) {
      const Range r = turn_to(latest);
      if (const Index bad = facets(latest, r.begin, r.end); bad >= 0) return bad;
      reflect_facets(latest);
    }
    if (const Index block = latest - lag; block >= 0 && block < n) {
      const auto b = static_cast<std::size_t>(block);
      const Index known = get_before(trail_.advanced, block), driven = get_before(trail_.driven, block);
      if (known < trail_.advanced[b])
        edges_.advance(dt, known * kBlockSize, find_range(trail_.advanced[b] - 1, geometry_.n_edges()).end);
      const Range r = turn_to(block);
      resultants(block, r.begin, r.end);
      for (Index i = driven; i < trail_.driven[b]; ++i) update_torques(i, dt);
    }
    if (const Index block = latest - 2 * lag; block >= 0) {
      const Range r = turn_to(block);
      kernels_.compute_corner_forces(rows_, r.begin, r.end);
      kernels_.gather_forces(rows_, force, get_before(trail_.gathered, block),
                             trail_.gathered[static_cast<std::size_t>(block)]);
    }
  }
  return -1;
}

}  // namespace interply::solve
