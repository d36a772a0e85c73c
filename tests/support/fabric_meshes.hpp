/// Flat meshes on which the tests of the ply measure what a mesh does to inextensible fibres.
#pragma once

#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "mechanics/mesh.hpp"

namespace interply::test {

inline mechanics::TriangleMesh make_mesh(const std::vector<Eigen::Vector2d>& nodes,
                                         const std::vector<std::array<int, 3>>& triangles) {
  mechanics::TriangleMesh mesh;
  mesh.reference = mechanics::NodalVectors::Zero(3, static_cast<Eigen::Index>(nodes.size()));
  for (std::size_t i = 0; i < nodes.size(); ++i)
    mesh.reference.col(static_cast<Eigen::Index>(i)).head(2) = nodes[i].array();
  mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t e = 0; e < triangles.size(); ++e)
    for (int k = 0; k < 3; ++k)
      mesh.triangles(k, static_cast<Eigen::Index>(e)) = triangles[e][static_cast<std::size_t>(k)];
  mesh.neighbours = mechanics::find_neighbours(mesh.triangles, mesh.n_nodes());
  return mesh;
}

/// Strip [0, W] x [0, H] of cells turned by 45 deg, legs along the fibres of a bias test; the long and short edges cut
/// border cells along their diagonals.
/// @param across, along  diagonals of a cell in W and H
/// @param diagonal       of a cell, mm
inline mechanics::TriangleMesh make_bias_strip(int across, int along, double diagonal) {
  std::vector<Eigen::Vector2d> nodes;
  std::map<std::pair<int, int>, int> number;  // in half diagonals
  for (int j = 0; j <= 2 * along; ++j)
    for (int i = j % 2; i <= 2 * across; i += 2) {
      number[{i, j}] = static_cast<int>(nodes.size());
      nodes.emplace_back(i * diagonal / 2, j * diagonal / 2);
    }
  std::vector<std::array<int, 3>> triangles;
  for (int j = 0; j <= 2 * along; ++j)
    for (int i = (j + 1) % 2; i <= 2 * across; i += 2) {
      const auto find = [&](int x, int y) {
        const auto found = number.find({x, y});
        return found == number.end() ? -1 : found->second;
      };
      const int west = find(i - 1, j), east = find(i + 1, j), south = find(i, j - 1), north = find(i, j + 1);
      if (west < 0)
        triangles.push_back({south, east, north});
      else if (east < 0)
        triangles.push_back({south, north, west});
      else if (south < 0)
        triangles.push_back({west, east, north});
      else if (north < 0)
        triangles.push_back({west, south, east});
      else if ((i + j + 1) / 2 % 2 == 0) {
        triangles.push_back({west, south, east});
        triangles.push_back({west, east, north});
      } else {
        triangles.push_back({south, east, north});
        triangles.push_back({south, north, west});
      }
    }
  return make_mesh(nodes, triangles);
}

enum class Diagonals { Alternating, OneWay, Unstructured };

inline std::string name_of(Diagonals d) {
  const char* names[] = {"alternating", "one-way", "unstructured"};
  return names[static_cast<int>(d)];
}

/// Rectangle [0, W] x [0, H] of square cells with diagonals as named; unstructured: each at random, and inner nodes
/// moved by up to a quarter of a cell.
inline mechanics::TriangleMesh make_grid(double width, double height, double h, Diagonals diagonals) {
  const int nx = static_cast<int>(std::lround(width / h)), ny = static_cast<int>(std::lround(height / h));
  std::mt19937 random(7);
  const auto draw = [&] { return static_cast<double>(random()) / 4294967296.0 - 0.5; };
  std::vector<Eigen::Vector2d> nodes;
  for (int j = 0; j <= ny; ++j)
    for (int i = 0; i <= nx; ++i) {
      nodes.emplace_back(i * width / nx, j * height / ny);
      if (diagonals == Diagonals::Unstructured && i > 0 && i < nx && j > 0 && j < ny)
        nodes.back() += h / 2 * Eigen::Vector2d(draw(), draw());
    }
  std::vector<std::array<int, 3>> triangles;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) {
      const int a = j * (nx + 1) + i, b = a + 1, c = a + nx + 2, d = a + nx + 1;
      const bool rising =
          diagonals == Diagonals::OneWay || (diagonals == Diagonals::Alternating ? (i + j) % 2 == 0 : draw() < 0);
      if (rising) {
        triangles.push_back({a, b, c});
        triangles.push_back({a, c, d});
      } else {
        triangles.push_back({a, b, d});
        triangles.push_back({b, c, d});
      }
    }
  return make_mesh(nodes, triangles);
}

}  // namespace interply::test
