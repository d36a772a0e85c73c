/// Parameter sets, meshes and differences that the tests of the woven ply share.
#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "mechanics/mesh.hpp"
#include "scene/scene.hpp"

namespace interply::fabric_cases {

inline constexpr double kDegree = std::numbers::pi / 180;

inline constexpr std::array<scene::Variant, 5> kVariants{scene::Variant::Fabric, scene::Variant::Uncoupled,
                                                         scene::Variant::Full, scene::Variant::Biaxial,
                                                         scene::Variant::NormalShear};

inline bool is_biaxial(scene::Variant v) { return v == scene::Variant::Full || v == scene::Variant::Biaxial; }
inline bool is_normal_shear(scene::Variant v) { return v == scene::Variant::Full || v == scene::Variant::NormalShear; }

inline std::string name_of(scene::Variant v) {
  const char* names[] = {"fabric", "uncoupled", "full", "biaxial", "normal_shear"};
  return names[static_cast<int>(v)];
}

/// Set `soft`: the defaults.
inline scene::WovenLaw soft(scene::Variant v = scene::Variant::Full) {
  scene::WovenLaw law;
  law.variant = v;
  return law;
}

/// Set `stiff` of deploy/scenes/laws.
inline scene::WovenLaw stiff(scene::Variant v = scene::Variant::Full) {
  scene::WovenLaw law = soft(v);
  law.a = {5.5e4, 5.5e4};
  law.b = {400, 400};
  law.c = {30, 30};
  law.strain_cap = {0.03, 0.03};
  return law;
}

/// Every pair different, so that no swap of a and b goes unseen.
inline scene::WovenLaw lopsided(scene::Variant v = scene::Variant::Full) {
  scene::WovenLaw law = soft(v);
  law.a = {7.1e3, 4.3e3};
  law.b = {130, 75};
  law.c = {22, 31};
  law.p_min = {0.75, 0.6};
  law.d = {90, 140};
  law.s_T = {260, 150};
  law.s_C = {700, 1300};
  law.strain_cap = {0.055, 0.07};
  return law;
}

inline std::vector<scene::WovenLaw> all_sets(scene::Variant v) { return {soft(v), stiff(v), lopsided(v)}; }

inline scene::Layer make_layer(const scene::WovenLaw& law, double orientation_deg = 0) {
  scene::Layer layer;
  layer.name = "ply_2";
  layer.thickness = 1.2;
  layer.density = 6.19e-10;
  layer.orientation_deg = orientation_deg;
  layer.law = law;
  layer.bending = {2.2, 1.4};
  layer.twist = 0.9;
  return layer;
}

/// f'(x) by central differences of sixth order.
inline double differentiate(const std::function<double(double)>& f, double x, double h) {
  return (45 * (f(x + h) - f(x - h)) - 9 * (f(x + 2 * h) - f(x - 2 * h)) + (f(x + 3 * h) - f(x - 3 * h))) / (60 * h);
}

/// Root of an increasing f in [low, high] by bisection to the last bit.
inline double find_root(const std::function<double(double)>& f, double low, double high) {
  for (int i = 0; i < 200; ++i) {
    const double middle = (low + high) / 2;
    (f(middle) < 0 ? low : high) = middle;
  }
  return (low + high) / 2;
}

/// Moves every node of a mesh in its plane by up to `amount` (mm) in each direction; nodes at y = 0 stay there if the
/// mesh is symmetric.
inline mechanics::TriangleMesh distort(mechanics::TriangleMesh mesh, double amount, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> move(-amount, amount);
  for (Eigen::Index i = 0; i < mesh.n_nodes(); ++i)
    for (int c = 0; c < 2; ++c) mesh.reference(c, i) += move(random);
  for (const int i : mesh.symmetry_nodes) mesh.reference(1, i) = 0;
  return mesh;
}

/// Rotation by `angle` about a slanted axis.
inline Eigen::Matrix3d slanted_rotation(double angle) {
  return Eigen::AngleAxisd(angle, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
}

/// Trellis shear by `gamma`: both fibres keep their length and turn by gamma/2 towards each other.
inline Eigen::Matrix2d trellis(double gamma) {
  Eigen::Matrix2d F;
  F << std::cos(gamma / 2), std::sin(gamma / 2), std::sin(gamma / 2), std::cos(gamma / 2);
  return F;
}

/// In-plane map of a flat mesh.
inline mechanics::NodalVectors map_in_plane(const mechanics::TriangleMesh& mesh, const Eigen::Matrix2d& F) {
  mechanics::NodalVectors x = mesh.reference;
  x.topRows(2) = (F * mesh.reference.topRows(2).matrix()).array();
  return x;
}

}  // namespace interply::fabric_cases
