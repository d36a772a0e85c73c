/// One layer and one interface alone, single-threaded, on the 4 mm half blank: elements (or contact points) per second.
///
///     build/release/bin/interply-benchmarks --benchmark_filter='layer|contact|tool'
#include <benchmark/benchmark.h>

#include <cmath>

#include "contact/layer_interface.hpp"
#include "contact/triangle_tool.hpp"
#include "geometry/stl.hpp"
#include "solver_fabric/fabric_layer.hpp"
#include "solver_metal/metal_layer.hpp"
#include "support/tool_surfaces.hpp"
#include "support/vumat_laws.hpp"

namespace {

using namespace interply;
using mechanics::NodalVectors;

mechanics::TriangleMesh make_blank(double z = 0) {
  return mechanics::make_rectangle({-140, 140}, {0, 140}, 4, z, true);
}

/// The blank bulged to a dome of height `h` and stretched by `strain` along x and -strain/2 along y.
NodalVectors deform(const mechanics::TriangleMesh& mesh, double h, double strain) {
  NodalVectors x = mesh.reference;
  x.row(2) += h * (mesh.reference.row(0) * (M_PI / 280)).cos() * (mesh.reference.row(1) * (M_PI / 280)).cos();
  x.row(0) *= 1 + strain;
  x.row(1) *= 1 - 0.5 * strain;
  return x;
}

/// Internal forces of a layer that swings between two shapes.
void run_layer(benchmark::State& state, solve::LayerMechanics& layer, const mechanics::TriangleMesh& mesh,
               const NodalVectors& one, const NodalVectors& other, const solve::Instant& now = {}) {
  NodalVectors force(3, mesh.n_nodes());
  std::int64_t n = 0;
  for (int i = 0; i < 20; ++i) layer.compute_internal_forces(i % 2 ? one : other, now, force);
  mechanics::Digest digest;
  digest.add(force);
  for (auto _ : state) layer.compute_internal_forces(n++ % 2 ? one : other, now, force);
  state.SetItemsProcessed(n * mesh.n_elements());
  state.SetLabel("digest " + mechanics::to_hex(digest.value()));
}

void fabric_layer(benchmark::State& state) {
  scene::Layer layer;
  layer.name = "ply";
  layer.thickness = 1.2;
  layer.density = 6.19e-10;
  layer.law = scene::WovenLaw{};
  const auto mesh = make_blank();
  fabric::FabricLayer ply(layer, 1, mesh);
  run_layer(state, ply, mesh, deform(mesh, 20, 0.002), deform(mesh, 20, 0.004));
}
BENCHMARK(fabric_layer);

/// The same law in Fortran.
void fabric_layer_vumat(benchmark::State& state) {
  scene::Layer layer;
  layer.name = "ply";
  layer.thickness = 1.2;
  layer.density = 6.19e-10;
  layer.law = test::make_woven_vumat({});
  const auto mesh = make_blank();
  fabric::FabricLayer ply(layer, 1, mesh);
  run_layer(state, ply, mesh, deform(mesh, 20, 0.002), deform(mesh, 20, 0.004), {.time = 1e-9, .dt = 1e-12});
}
BENCHMARK(fabric_layer_vumat);

void metal_layer(benchmark::State& state, double swing) {
  scene::Layer layer;
  layer.name = "sheet";
  layer.law = scene::J2Law{};
  const auto mesh = make_blank();
  metal::MetalLayer sheet(layer, 7.85e-9, mesh);
  run_layer(state, sheet, mesh, deform(mesh, 0.1, swing), deform(mesh, 0.1, -swing));
}
BENCHMARK_CAPTURE(metal_layer, elastic, 1e-5);
BENCHMARK_CAPTURE(metal_layer, plastic, 2e-3);

void contact_interface(benchmark::State& state) {
  struct Layer {
    mechanics::TriangleMesh mesh;
    contact::VertexNormals normals;
    contact::LayerGeometry geometry;
    explicit Layer(double z) : mesh(make_blank(z)), normals(mesh) {
      geometry = contact::LayerGeometry::at_rest(mesh, normals, 1, 1e-9);
      geometry.move_to(deform(mesh, 20, 0));
    }
  } lower(0), upper(0.99);
  contact::LayerInterface interface({.stiffness = 500, .tangential = 500, .damping = 1e-5, .friction = 0.25},
                                    lower.geometry, upper.geometry);
  interface.update(0);
  mechanics::Digest digest;
  digest.add(interface.force_on_lower());
  digest.add(interface.force_on_upper());
  std::int64_t n = 0;
  double direction = 0.01;
  NodalVectors shifted;
  for (auto _ : state) {
    if (n % 100 == 50) direction = -direction;
    shifted = lower.geometry.position;
    shifted.row(0) += direction;
    lower.geometry.move_to(shifted);
    upper.geometry.move_to(upper.geometry.position);
    interface.update(1e-6);
    ++n;
  }
  state.SetItemsProcessed(n * lower.mesh.n_nodes());
  state.SetLabel("digest " + mechanics::to_hex(digest.value()));
}
BENCHMARK(contact_interface);

/// Distances of a tool at the nodes of the domed blank: what a step pays where nothing may be skipped.
void run_tool(benchmark::State& state, const contact::SignedDistance& tool) {
  const auto mesh = make_blank();
  const NodalVectors x = deform(mesh, -20, 0);
  mechanics::Scalars distance(mesh.n_nodes());
  for (auto _ : state)
    for (Eigen::Index i = 0; i < mesh.n_nodes(); ++i)
      distance(i) = tool.evaluate(mechanics::at(x, i) + contact::Vector3(0, 0, 20)).value;
  mechanics::Digest digest;
  digest.add(distance);
  state.SetItemsProcessed(state.iterations() * mesh.n_nodes());
  state.SetLabel("digest " + mechanics::to_hex(digest.value()));
}

void tool_punch(benchmark::State& state) { run_tool(state, contact::PyramidPunch(100, 50, 15)); }
BENCHMARK(tool_punch);

void tool_die(benchmark::State& state) { run_tool(state, contact::OpeningPlate(100, 22, 10, true)); }
BENCHMARK(tool_die);

void tool_from_stl(benchmark::State& state, const test::Soup& soup) {
  const auto surface = geometry::parse_stl(test::to_binary_stl(soup), "tool.stl");
  run_tool(state, contact::TriangleTool(surface.vertices, surface.triangles));
}
BENCHMARK_CAPTURE(tool_from_stl, punch_5500_triangles, test::make_punch(100, 50, 15, 60, 20));
BENCHMARK_CAPTURE(tool_from_stl, die_5500_triangles, test::make_plate(100, 22, 10, 80, 160, 20, true));

}  // namespace
