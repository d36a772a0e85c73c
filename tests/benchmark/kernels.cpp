/// One layer and one interface alone, single-threaded, on the 4 mm half blank: elements (or contact points) per second.
///
///     build/release/bin/interply-benchmarks --benchmark_filter='layer|contact'
#include <benchmark/benchmark.h>

#include <cmath>

#include "contact/layer_interface.hpp"
#include "solver_fabric/fabric_layer.hpp"
#include "solver_metal/metal_layer.hpp"

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
               const NodalVectors& one, const NodalVectors& other) {
  NodalVectors force(3, mesh.n_nodes());
  std::int64_t n = 0;
  for (int i = 0; i < 20; ++i) layer.compute_internal_forces(i % 2 ? one : other, 0, force);
  mechanics::Digest digest;
  digest.add(force);
  for (auto _ : state) layer.compute_internal_forces(n++ % 2 ? one : other, 0, force);
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
      geometry.mesh = &mesh;
      geometry.normals = &normals;
      geometry.position = deform(mesh, 20, 0);
      geometry.increment = geometry.normal = NodalVectors::Zero(3, mesh.n_nodes());
      geometry.half_thickness = mechanics::Scalars::Constant(mesh.n_nodes(), 0.5);
      geometry.mass = mechanics::compute_lumped_mass(mesh, 1, 1e-9);
      normals.compute(geometry.position, geometry.normal);
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
  for (auto _ : state) {
    if (n % 100 == 50) direction = -direction;
    lower.geometry.increment.row(0) = direction;
    lower.geometry.position.row(0) += direction;
    lower.normals.compute(lower.geometry.position, lower.geometry.normal);
    upper.normals.compute(upper.geometry.position, upper.geometry.normal);
    interface.update(1e-6);
    ++n;
  }
  state.SetItemsProcessed(n * lower.mesh.n_nodes());
  state.SetLabel("digest " + mechanics::to_hex(digest.value()));
}
BENCHMARK(contact_interface);

}  // namespace
