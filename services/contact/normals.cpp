#include "contact/normals.hpp"

#include <cmath>

namespace interply::contact {

using mechanics::Vector3;

VertexNormals::VertexNormals(const mechanics::TriangleMesh& mesh)
    : mesh_(mesh),
      around_(mechanics::make_incidence(mesh.triangles.data(), 3, mesh.n_elements(), mesh.n_nodes())),
      area_vectors_(3, mesh.n_elements()) {
  for (int& entry : around_.entry) entry %= static_cast<int>(mesh.n_elements());  // the slot does not matter here
}

void VertexNormals::compute(const mechanics::NodalVectors& x, mechanics::NodalVectors& normals) {
  for (Eigen::Index e = 0; e < mesh_.n_elements(); ++e) {
    const int a = mesh_.triangles(0, e), b = mesh_.triangles(1, e), c = mesh_.triangles(2, e);
    const double ux = x(0, b) - x(0, a), uy = x(1, b) - x(1, a), uz = x(2, b) - x(2, a);
    const double vx = x(0, c) - x(0, a), vy = x(1, c) - x(1, a), vz = x(2, c) - x(2, a);
    area_vectors_(0, e) = uy * vz - uz * vy;
    area_vectors_(1, e) = uz * vx - ux * vz;
    area_vectors_(2, e) = ux * vy - uy * vx;
  }
  for (Eigen::Index i = 0; i < mesh_.n_nodes(); ++i) {
    Vector3 sum = Vector3::Zero();
    for (int k = around_.start[i]; k < around_.start[i + 1]; ++k) sum += mechanics::at(area_vectors_, around_.entry[k]);
    const double inv = 1 / sum.norm();
    for (int d = 0; d < 3; ++d) normals(d, i) = sum(d) * inv;
  }
  for (const int i : mesh_.symmetry_nodes) {
    const double inv = 1 / std::hypot(normals(0, i), normals(2, i));
    normals(0, i) *= inv;
    normals(1, i) = 0;
    normals(2, i) *= inv;
  }
}

}  // namespace interply::contact
