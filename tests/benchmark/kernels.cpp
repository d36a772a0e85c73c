/// One layer and one interface alone, single-threaded, on the 4 mm half blank: elements (or contact points) per second.
///
///     build/release/bin/interply-benchmarks --benchmark_filter='layer|contact|tool'
#include <benchmark/benchmark.h>

#include "contact/layer_interface.hpp"
#include "contact/tool_interface.hpp"
#include "contact/triangle_tool.hpp"
#include "geometry/stl.hpp"
#include "layers.hpp"
#include "support/tool_surfaces.hpp"
#include "support/vumat_laws.hpp"

namespace {

using namespace interply;
using benchmarks::deform;
using benchmarks::make_blank;
using benchmarks::run_layer;
using mechanics::NodalVectors;

void fabric_layer(benchmark::State& state) {
  const scene::Layer layer = benchmarks::make_ply();
  const auto mesh = make_blank();
  fabric::FabricLayer ply(layer, 1, mesh);
  run_layer(state, ply, mesh, deform(mesh, 20, 0.002), deform(mesh, 20, 0.004), {}, benchmarks::kFabricWork);
}
BENCHMARK(fabric_layer);

/// First pass of a ply alone: facets, law and membrane forces, without bending, edges and the sum over the nodes.
void fabric_stretch_invariant(benchmark::State& state) {
  const auto mesh = make_blank();
  const mechanics::ShellGeometry shell = mechanics::make_shell_geometry(mesh, 0);
  mechanics::ShellPasses passes(shell);
  const mechanics::ShellRows rows(shell, passes);
  const fabric::MembraneLaw law = fabric::make_membrane_law(scene::WovenLaw{});
  const NodalVectors shapes[] = {deform(mesh, 20, 0.002), deform(mesh, 20, 0.004)};
  const auto stretch = [&](const NodalVectors& x) {
    const double* const at[3] = {&x(0, 0), &x(1, 0), &x(2, 0)};
    return fabric::choose_fabric_kernels().stretch(rows, at, law, 1.2, 0, mesh.n_elements()).energy;
  };
  stretch(shapes[1]);
  mechanics::Digest digest;
  digest.add(passes.membrane);
  std::size_t n = 0;
  for (auto _ : state) benchmark::DoNotOptimize(stretch(shapes[n++ % 2]));
  state.SetItemsProcessed(state.iterations() * mesh.n_elements());
  state.SetLabel("digest " + mechanics::to_hex(digest.value()));
}
BENCHMARK(fabric_stretch_invariant);

/// The same law in Fortran.
void fabric_layer_vumat(benchmark::State& state) {
  scene::Layer layer = benchmarks::make_ply();
  layer.law = test::make_woven_vumat({});
  const auto mesh = make_blank();
  fabric::FabricLayer ply(layer, 1, mesh);
  run_layer(state, ply, mesh, deform(mesh, 20, 0.002), deform(mesh, 20, 0.004), {.time = 1e-9, .dt = 1e-12});
}
BENCHMARK(fabric_layer_vumat);

void metal_layer(benchmark::State& state, double swing) {
  const scene::Layer layer = benchmarks::make_sheet();
  const auto mesh = make_blank();
  metal::MetalLayer sheet(layer, 7.85e-9, mesh);
  run_layer(state, sheet, mesh, deform(mesh, 0.1, swing), deform(mesh, 0.1, -swing), {},
            swing < 1e-4 ? benchmarks::kElasticWork : benchmarks::kPlasticWork);
}
BENCHMARK_CAPTURE(metal_layer, elastic, 1e-5);
BENCHMARK_CAPTURE(metal_layer, plastic, 2e-3);

void contact_interface(benchmark::State& state) {
  struct Layer {
    mechanics::TriangleMesh mesh;
    contact::LayerGeometry geometry;
    explicit Layer(double z) : mesh(make_blank(4, z)), geometry(mesh, 1, 1e-9) {
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
  const NodalVectors still = upper.geometry.positions();
  for (auto _ : state) {
    if (n % 100 == 50) direction = -direction;
    shifted = lower.geometry.positions();
    shifted.row(0) += direction;
    lower.geometry.move_to(shifted);
    upper.geometry.move_to(still);
    interface.update(1e-6);
    ++n;
  }
  state.SetItemsProcessed(n * lower.mesh.n_nodes());
  state.SetLabel("digest " + mechanics::to_hex(digest.value()));
}
BENCHMARK(contact_interface);

/// A flat blank that slides on a die: most of its nodes touch all the time, as those of the flange do.
void contact_tool(benchmark::State& state) {
  const auto mesh = make_blank(4, 0.49);
  contact::LayerGeometry layer(mesh, 1, 1e-9);
  contact::Tool die{.name = "die", .shape = std::make_unique<contact::OpeningPlate>(100, 22, 10, true)};
  contact::ToolInterface interface({.stiffness = 500, .tangential = 500, .damping = 1e-5, .friction = 0.25}, layer,
                                   die);
  interface.update(0);
  mechanics::Digest digest;
  digest.add(interface.force_on_layer());
  std::int64_t n = 0;
  double direction = 0.01;
  for (auto _ : state) {
    if (n % 100 == 50) direction = -direction;
    for (Eigen::Index i = 0; i < layer.n_nodes(); ++i) {
      layer.node(i).increment.x = direction;
      layer.node(i).position.x += direction;
    }
    interface.update(1e-6);
    ++n;
  }
  state.SetItemsProcessed(n * mesh.n_nodes());
  state.SetLabel("digest " + mechanics::to_hex(digest.value()));
}
BENCHMARK(contact_tool);

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
