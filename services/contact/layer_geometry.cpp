#include "contact/layer_geometry.hpp"

namespace interply::contact {

using Eigen::Index;

LayerGeometry LayerGeometry::at_rest(const mechanics::TriangleMesh& mesh, VertexNormals& normals, double thickness,
                                     double density) {
  const NodalVectors zero = NodalVectors::Zero(3, mesh.n_nodes());
  LayerGeometry g{.mesh = &mesh, .normals = &normals, .position = mesh.reference};
  g.increment = g.normal = g.turn = zero;
  g.half_thickness = Scalars::Constant(mesh.n_nodes(), 0.5 * thickness);
  g.mass = mechanics::compute_lumped_mass(mesh, thickness, density);
  g.move_to(mesh.reference);
  g.turn = zero;
  return g;
}

void LayerGeometry::move_to(const NodalVectors& x) {
  for (int d = 0; d < 3; ++d) {
    const double* from = &x(d, 0);
    double *to = &position(d, 0), *by = &increment(d, 0);
    for (Index i = 0; i < position.cols(); ++i) {
      const double next = from[i];
      by[i] = next - to[i];
      to[i] = next;
    }
  }
  normals->compute(position, normal, turn);
}

}  // namespace interply::contact
