/// Triangulated tools whose every vertex lies on a known surface, and STL files of them.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "mechanics/nodal.hpp"

namespace interply::test {

using mechanics::Vector2;
using mechanics::Vector3;

/// Corners of triangles, three by three, counter-clockwise seen from outside.
using Soup = std::vector<Vector3>;

/// Adds a triangle, turned so that its normal points along `outside`.
inline void add_triangle(Soup& soup, const Vector3& a, Vector3 b, Vector3 c, const Vector3& outside) {
  if ((b - a).cross(c - a).dot(outside) < 0) std::swap(b, c);
  soup.insert(soup.end(), {a, b, c});
}

/// A quadrilateral as two triangles.
inline void add_quad(Soup& soup, const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d,
                     const Vector3& outside) {
  add_triangle(soup, a, b, c, outside);
  add_triangle(soup, a, c, d, outside);
}

/// centre + radius n for the normals n between three directions, m x m facets.
inline void add_ball_sector(Soup& soup, const Vector3& centre, double radius, const std::array<Vector3, 3>& n, int m) {
  const auto at = [&](int i, int j) -> Vector3 { return (n[0] * (m - i - j) + n[1] * i + n[2] * j).normalized(); };
  const auto add = [&](const Vector3& a, const Vector3& b, const Vector3& c) {
    add_triangle(soup, centre + radius * a, centre + radius * b, centre + radius * c, a + b + c);
  };
  for (int i = 0; i < m; ++i) {
    for (int j = 0; i + j < m; ++j) {
      add(at(i, j), at(i + 1, j), at(i, j + 1));
      if (i + j + 1 < m) add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
}

/// Cylinder of `radius` around the edge from a to b, between the normals n and l, m facets.
inline void add_round_edge(Soup& soup, const Vector3& a, const Vector3& b, double radius, const Vector3& n,
                           const Vector3& l, int m) {
  const auto at = [&](int i) -> Vector3 { return (n * (m - i) + l * i).normalized(); };
  for (int i = 0; i < m; ++i) {
    const Vector3 p = radius * at(i), q = radius * at(i + 1);
    add_quad(soup, a + p, b + p, b + q, a + q, p + q);
  }
}

/// Ball: an octahedron, each face m x m facets.
inline Soup make_ball(double radius, int m) {
  Soup soup;
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      for (const double z : {-1.0, 1.0})
        add_ball_sector(soup, Vector3::Zero(), radius,
                        {x * Vector3::UnitX(), y * Vector3::UnitY(), z * Vector3::UnitZ()}, m);
  return soup;
}

/// The box |x_i| <= half_i, twelve facets.
inline Soup make_box(const Vector3& half) {
  Soup soup;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3 u = half((axis + 1) % 3) * Vector3::Unit((axis + 1) % 3);
    const Vector3 v = half((axis + 2) % 3) * Vector3::Unit((axis + 2) % 3);
    for (const double side : {-1.0, 1.0}) {
      const Vector3 w = side * half(axis) * Vector3::Unit(axis);
      add_quad(soup, w + u + v, w - u + v, w - u - v, w + u - v, w);
    }
  }
  return soup;
}

/// Outline of contact::Triangle2: corners of edge `e` and outward normals of the sides (side k from corner k to k + 1).
struct TriangleOutline {
  std::array<Vector3, 3> corner, normal;
  explicit TriangleOutline(double e) {
    for (int k = 0; k < 3; ++k) {
      const double angle = 2 * M_PI / 3 * k, across = angle + M_PI / 3;
      corner[static_cast<std::size_t>(k)] = e / std::sqrt(3.0) * Vector3(std::cos(angle), std::sin(angle), 0);
      normal[static_cast<std::size_t>(k)] = Vector3(std::cos(across), std::sin(across), 0);
    }
  }
};

/// contact::PyramidPunch cut off and closed at height `top` above its base: flat faces exact, m facets over each
/// rounding.
inline Soup make_punch(double edge, double height, double radius, double top, int m) {
  Soup soup;
  const TriangleOutline flat(edge);
  const Vector3 apex(0, 0, radius), up = Vector3::UnitZ();
  std::array<Vector3, 3> base, end, face;  // of the sharp body; face k between corners k and k + 1
  for (std::size_t k = 0; k < 3; ++k) {
    base[k] = flat.corner[k] + (radius + height) * up;
    end[k] = base[k] + top * up;
  }
  for (std::size_t k = 0; k < 3; ++k) {
    face[k] = (base[k] - apex).cross(base[(k + 1) % 3] - apex).normalized();
    if (face[k].z() > 0) face[k] = -face[k];
  }
  add_ball_sector(soup, apex, radius, face, m);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3, last = (k + 2) % 3;
    const Vector3 &f = face[k], &before = face[last], &wall = flat.normal[k], &wall_before = flat.normal[last];
    add_triangle(soup, apex + radius * f, base[k] + radius * f, base[next] + radius * f, f);
    const Vector3 w = radius * wall;
    add_quad(soup, base[k] + w, base[next] + w, end[next] + w, end[k] + w, wall);
    add_round_edge(soup, apex, base[k], radius, before, f, m);
    add_round_edge(soup, base[k], base[next], radius, f, wall, m);
    add_round_edge(soup, base[k], end[k], radius, wall_before, wall, m);
    const Vector3 middle = (f + before + wall + wall_before).normalized();
    add_ball_sector(soup, base[k], radius, {f, before, middle}, m);
    add_ball_sector(soup, base[k], radius, {before, wall_before, middle}, m);
    add_ball_sector(soup, base[k], radius, {wall_before, wall, middle}, m);
    add_ball_sector(soup, base[k], radius, {wall, f, middle}, m);
    const Vector3 centre(0, 0, end[k].z());  // lid
    add_triangle(soup, centre, end[k] + w, end[next] + w, up);
    for (int i = 0; i < m; ++i) {
      const auto rim = [&](int j) -> Vector3 {
        return end[k] + radius * (wall_before * (m - j) + wall * j).normalized();
      };
      add_triangle(soup, centre, rim(i), rim(i + 1), up);
    }
  }
  return soup;
}

/// contact::OpeningPlate facing up: wall of `depth`, shoulder, land up to `reach` beyond the wall; `closed` adds a flat
/// bottom and an outer wall, so that it is a solid. m facets over the shoulder, 2 m over the 120 deg of a corner.
inline Soup make_plate(double edge, double offset, double shoulder, double depth, double reach, int m, bool closed) {
  std::vector<std::pair<Vector3, Vector3>> ring;  // nearest point of the sharp triangle, horizontal normal
  const TriangleOutline flat(edge);
  for (std::size_t k = 0; k < 3; ++k) {
    for (int i = 0; i <= 2 * m; ++i) {  // 120 deg around each corner
      const double angle = 2 * M_PI / 3 * (static_cast<double>(k) - 0.5 + 0.5 * i / m);
      ring.emplace_back(flat.corner[k], Vector3(std::cos(angle), std::sin(angle), 0));
    }
  }
  std::vector<Vector2> profile;  // distance beyond the wall, height
  profile.emplace_back(0, -depth);
  for (int i = 0; i <= m; ++i) {
    const double angle = M_PI / 2 * i / m;
    profile.emplace_back(shoulder * (1 - std::cos(angle)), shoulder * (std::sin(angle) - 1));
  }
  profile.emplace_back(reach, 0);
  if (closed) profile.insert(profile.end(), {Vector2(reach, -depth), Vector2(0, -depth)});
  Soup soup;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const auto& [a, n] = ring[i];
    const auto& [b, l] = ring[(i + 1) % ring.size()];
    for (std::size_t j = 0; j + 1 < profile.size(); ++j) {
      const Vector2 p = profile[j], q = profile[j + 1];
      const auto at = [&](const Vector3& x, const Vector3& normal, const Vector2& s) -> Vector3 {
        return x + (offset + s.x()) * normal + Vector3(0, 0, s.y());
      };
      const Vector3 outside = (p.y() - q.y()) * (n + l) / 2 + Vector3(0, 0, q.x() - p.x());
      add_quad(soup, at(a, n, p), at(b, l, p), at(b, l, q), at(a, n, q), outside);
    }
  }
  return soup;
}

/// Upside down: a die becomes a blank holder (y changes its sign, too: no mirror image).
inline Soup turn_over(Soup soup) {
  for (Vector3& x : soup) x = Vector3(x.x(), -x.y(), -x.z());
  return soup;
}

/// Content of a binary STL file.
inline std::string to_binary_stl(const Soup& soup) {
  std::string content(84, '\0');
  const auto n = static_cast<std::uint32_t>(soup.size() / 3);
  std::memcpy(content.data() + 80, &n, sizeof n);
  for (std::size_t t = 0; t < soup.size(); t += 3) {
    float numbers[12] = {};
    for (std::size_t k = 0; k < 9; ++k)
      numbers[3 + k] = static_cast<float>(soup[t + k / 3](static_cast<Eigen::Index>(k % 3)));
    content.append(reinterpret_cast<const char*>(numbers), sizeof numbers).append(2, '\0');
  }
  return content;
}

/// The same as text, every digit of every corner.
inline std::string to_ascii_stl(const Soup& soup) {
  std::string content = "solid tool\n";
  for (std::size_t t = 0; t < soup.size(); t += 3) {
    content += "  facet normal 0 0 0\n    outer loop\n";
    for (std::size_t k = 0; k < 3; ++k) {
      char line[120];
      std::snprintf(line, sizeof line, "      vertex %.17g %.17g %.17g\n", soup[t + k].x(), soup[t + k].y(),
                    soup[t + k].z());
      content += line;
    }
    content += "    endloop\n  endfacet\n";
  }
  return content + "endsolid tool\n";
}

inline void write_file(const std::string& path, const std::string& content) {
  std::ofstream out(path, std::ios::binary);
  out << content;
  if (!out.flush()) throw std::runtime_error("cannot write " + path);
}

}  // namespace interply::test
