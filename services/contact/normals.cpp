#include "contact/normals.hpp"

#include <algorithm>
#include <cmath>

namespace interply::contact {

VertexNormals::VertexNormals(const mechanics::TriangleMesh& mesh)
    : mesh_(mesh),
      position_(static_cast<std::size_t>(mesh.n_nodes())),
      area_(static_cast<std::size_t>(mesh.n_nodes())),
      length_(mesh.n_nodes()),
      sideways_(mechanics::Scalars::Ones(mesh.n_nodes())) {
  for (const int i : mesh.symmetry_nodes) sideways_(i) = 0;
}

void VertexNormals::compute(const mechanics::NodalVectors& position, mechanics::NodalVectors& normal,
                            mechanics::NodalVectors& turn) {
  const Index n = mesh_.n_nodes();
  const double *x = &position(0, 0), *y = &position(1, 0), *z = &position(2, 0);
  Quad *at = position_.data(), *area = area_.data();
  for (Index i = 0; i < n; ++i) {
    at[i] = {x[i], y[i], z[i], 0};
    area[i] = {};
  }
  const int *a = &mesh_.triangles(0, 0), *b = &mesh_.triangles(1, 0), *c = &mesh_.triangles(2, 0);
  for (Index e = 0; e < mesh_.n_elements(); ++e) {
    const Four first = load(at[a[e]]), twice = cross(load(at[b[e]]) - first, load(at[c[e]]) - first);
    add_to(area[a[e]], twice);
    add_to(area[b[e]], twice);
    add_to(area[c[e]], twice);
  }
  constexpr Index kChunk = 128;
  double sum[3][kChunk], inverse[kChunk];
  for (Index first = 0; first < n; first += kChunk) {
    const Index m = std::min(kChunk, n - first);
    const double* sideways = &sideways_(first);
    double* length = &length_(first);
    for (Index i = 0; i < m; ++i) {
      sum[0][i] = area[first + i].x;
      sum[1][i] = area[first + i].y * sideways[i];
      sum[2][i] = area[first + i].z;
    }
    for (Index i = 0; i < m; ++i) {
      length[i] = std::sqrt(sum[0][i] * sum[0][i] + sum[1][i] * sum[1][i] + sum[2][i] * sum[2][i]);
      inverse[i] = 1 / length[i];
    }
    for (int d = 0; d < 3; ++d) {
      double *to = &normal(d, first), *by = &turn(d, first);
      for (Index i = 0; i < m; ++i) {
        const double now = sum[d][i] * inverse[i];
        by[i] = now - to[i];
        to[i] = now;
      }
    }
  }
}

void VertexNormals::turn_pulls_to_areas(const mechanics::NodalVectors& normal, Quad* records) const {
  const double *nx = &normal(0, 0), *ny = &normal(1, 0), *nz = &normal(2, 0);
  const auto project = [&](auto px, auto py, auto pz, auto x, auto y, auto z, auto length, auto sideways, auto put) {
    const auto along = px * x + py * y + pz * z;
    const auto inverse = 1 / length;
    put((px - along * x) * inverse, (py - along * y) * inverse * sideways, (pz - along * z) * inverse);
  };
  const auto four = [](const double* row) {
    Four a;
    __builtin_memcpy(&a, row, sizeof a);
    return a;
  };
  const Index n = mesh_.n_nodes();
  Index i = 0;
  for (; i + 4 <= n; i += 4) {
    Quad* pull = records + 2 * i + 1;
    Four p[4] = {load(pull[0]), load(pull[2]), load(pull[4]), load(pull[6])};
    transpose(p[0], p[1], p[2], p[3]);
    project(p[0], p[1], p[2], four(nx + i), four(ny + i), four(nz + i), four(&length_(i)), four(&sideways_(i)),
            [&](Four x, Four y, Four z) {
              Four u = {0, 0, 0, 0};
              transpose(x, y, z, u);
              store(pull[0], x);
              store(pull[2], y);
              store(pull[4], z);
              store(pull[6], u);
            });
  }
  for (; i < n; ++i) {
    Quad& pull = records[2 * i + 1];
    project(pull.x, pull.y, pull.z, nx[i], ny[i], nz[i], length_(i), sideways_(i), [&](double x, double y, double z) {
      pull = {x, y, z, 0};
    });
  }
}

void VertexNormals::add_forces_of_pulls(const mechanics::NodalVectors& normal, Quad* records) const {
  turn_pulls_to_areas(normal, records);
  const int *a = &mesh_.triangles(0, 0), *b = &mesh_.triangles(1, 0), *c = &mesh_.triangles(2, 0);
  const Quad *x = position_.data(), *pull = records + 1;
  for (Index e = 0; e < mesh_.n_elements(); ++e) {  // s is a sum of u x v over the triangles
    const int i = a[e], j = b[e], k = c[e];
    const Four q = load(pull[2 * i]) + load(pull[2 * j]) + load(pull[2 * k]);
    const Four first = load(x[i]), on_j = cross(load(x[k]) - first, q), on_k = cross(q, load(x[j]) - first);
    add_to(records[2 * i], -on_j - on_k);
    add_to(records[2 * j], on_j);
    add_to(records[2 * k], on_k);
  }
}

}  // namespace interply::contact
