#include "contact/normals.hpp"

#include <cmath>

namespace interply::contact {

using mechanics::Vector3;

VertexNormals::VertexNormals(const mechanics::TriangleMesh& mesh)
    : mesh_(mesh),
      around_(mechanics::make_incidence(mesh.triangles.data(), 3, mesh.n_elements(), mesh.n_nodes())),
      area_vectors_(3, mesh.n_elements()),
      length_(mesh.n_nodes()) {
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
    length_(i) = sum.norm();
    for (int d = 0; d < 3; ++d) normals(d, i) = sum(d) / length_(i);
  }
  for (const int i : mesh_.symmetry_nodes) {
    const double in_plane = std::hypot(normals(0, i), normals(2, i));
    normals(0, i) /= in_plane;
    normals(1, i) = 0;
    normals(2, i) /= in_plane;
    length_(i) *= in_plane;
  }
}

void VertexNormals::add_forces_to(const mechanics::NodalVectors& x, const mechanics::NodalVectors& normals,
                                  mechanics::NodalVectors& pull, mechanics::NodalVectors& force) const {
  for (Eigen::Index i = 0; i < mesh_.n_nodes(); ++i) {  // dn = (I - n n) ds / |s|
    const double along = pull(0, i) * normals(0, i) + pull(1, i) * normals(1, i) + pull(2, i) * normals(2, i);
    for (int d = 0; d < 3; ++d) pull(d, i) = (pull(d, i) - along * normals(d, i)) / length_(i);
  }
  for (const int i : mesh_.symmetry_nodes) pull(1, i) = 0;
  for (Eigen::Index e = 0; e < mesh_.n_elements(); ++e) {  // s is a sum of u x v over the triangles
    const int a = mesh_.triangles(0, e), b = mesh_.triangles(1, e), c = mesh_.triangles(2, e);
    const Vector3 q = mechanics::at(pull, a) + mechanics::at(pull, b) + mechanics::at(pull, c);
    const Vector3 u = mechanics::at(x, b) - mechanics::at(x, a), v = mechanics::at(x, c) - mechanics::at(x, a);
    const Vector3 on_b = v.cross(q), on_c = q.cross(u);
    mechanics::add_at(force, b, on_b);
    mechanics::add_at(force, c, on_c);
    mechanics::add_at(force, a, -on_b - on_c);
  }
}

}  // namespace interply::contact
