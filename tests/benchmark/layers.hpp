/// Layers for the benchmarks: a blank bulged to a dome, swinging between two shapes.
#pragma once

#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>

#include "solver_fabric/fabric_layer.hpp"
#include "solver_metal/metal_layer.hpp"

namespace interply::benchmarks {

using mechanics::NodalVectors;

/// Half blank, z = const. @param h  mm, side of the elements
inline mechanics::TriangleMesh make_blank(double h = 4, double z = 0) {
  return mechanics::make_rectangle({-140, 140}, {0, 140}, h, z, true);
}

/// The blank bulged to a dome of height `h` and stretched by `strain` along x and -strain/2 along y.
inline NodalVectors deform(const mechanics::TriangleMesh& mesh, double h, double strain) {
  NodalVectors x = mesh.reference;
  x.row(2) += h * (mesh.reference.row(0) * (M_PI / 280)).cos() * (mesh.reference.row(1) * (M_PI / 280)).cos();
  x.row(0) *= 1 + strain;
  x.row(1) *= 1 - 0.5 * strain;
  return x;
}

inline scene::Layer make_ply() {
  scene::Layer layer;
  layer.name = "ply";
  layer.thickness = 1.2;
  layer.density = 6.19e-10;
  layer.law = scene::WovenLaw{};
  return layer;
}

inline scene::Layer make_sheet() {
  scene::Layer layer;
  layer.name = "sheet";
  layer.law = scene::J2Law{};
  return layer;
}

/// What one element costs, counted from the sources: bytes of the arrays that a step reads (constants and state once),
/// without the rings of what one pass hands to the next, which stay in the cache; flops with a fused multiply-add as 2,
/// a division or root as 1, exp and log as 25, atan as 35.
struct Work {
  double bytes = 0, flops = 0;
};
/// Facet 43, curvature 188, moments 39, corner forces 242, 1.5 edges 47, sum over the nodes 9. Bytes: 12 indices, 7
/// constants, 6 signs, 1.5 edges (2 indices, 3 constants, 4 read and written), position and force.
inline constexpr Work kShell{292, 568};
/// Strains of the fibres 58, law 206 with both exponentials of both families, stress and moments 28.
inline constexpr Work kFabricWork{kShell.bytes, kShell.flops + 292};
/// Per element 190, per point 50; 7 doubles of state per element and 3 per point, written back, and the yield stress.
inline constexpr Work kElasticWork{kShell.bytes + 112 + 5 * 56, kShell.flops + 190 + 5 * 50};
/// All points return to the yield surface, some 2.5 Newton steps of 110 each; all hardening is written back.
inline constexpr Work kPlasticWork{kElasticWork.bytes + 5 * 40, kElasticWork.flops + 5 * 300};

/// Internal forces of a layer that swings between two shapes.
inline void run_layer(benchmark::State& state, solve::LayerMechanics& layer, const mechanics::TriangleMesh& mesh,
                      const NodalVectors& one, const NodalVectors& other, const solve::Instant& now = {},
                      const Work& work = {}) {
  NodalVectors force(3, mesh.n_nodes());
  std::int64_t n = 0;
  for (int i = 0; i < 20; ++i) layer.compute_internal_forces(i % 2 ? one : other, now, force);
  mechanics::Digest digest;
  digest.add(force);
  for (auto _ : state) layer.compute_internal_forces(n++ % 2 ? one : other, now, force);
  const auto element_steps = static_cast<double>(n * mesh.n_elements());
  state.SetItemsProcessed(n * mesh.n_elements());
  if (work.bytes > 0) {
    state.counters["bytes_per_s"] = benchmark::Counter(work.bytes * element_steps, benchmark::Counter::kIsRate);
    state.counters["flops_per_s"] = benchmark::Counter(work.flops * element_steps, benchmark::Counter::kIsRate);
  }
  state.SetLabel("digest " + mechanics::to_hex(digest.value()));
}

}  // namespace interply::benchmarks
