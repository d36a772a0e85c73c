/// A flexible belt over a rigid drum: the real fabric solver and the real tool contact, a test holds its two ends.
#pragma once

#include <cmath>

#include "contact/tool_interface.hpp"
#include "solver_fabric/fabric_layer.hpp"
#include "support/free_layers.hpp"

namespace interply::test {

/// A cylinder about the y axis.
class Drum : public contact::SignedDistance {
 public:
  explicit Drum(double radius) : radius_(radius) {}
  contact::Distance evaluate(const Vector3& x) const override {
    const double r = std::hypot(x.x(), x.z());
    return {.value = r - radius_, .gradient = Vector3(x.x() / r, 0, x.z() / r)};
  }

 private:
  double radius_;
};

/// Belt of one ply, warp along its length, linear in warp and weft (2 b per strain), no bending stiffness, laid over
/// the upper half of a drum: wrapped by `wrap` and straight beyond, symmetric about x = 0. Its slack end (s < 0) is
/// loaded with a tension, its other end is loaded, too, or pulled along its tangent at a given speed.
class BeltOnDrum {
 public:
  static constexpr double kThickness = 1.0, kStiffness = 2e4, kDensity = 6e-10;  // mm, 2 b MPa, t/mm3
  struct Setup {
    double radius = 50, wrap = M_PI / 2, tail = 20, width = 4;  ///< of the drum mm, rad, mm, mm
    double h = 4;                                               ///< mm
    double tension = 10;                                        ///< N/mm
    double friction = 0;
  };

  explicit BeltOnDrum(const Setup& s)
      : setup_(s),
        mean_radius_(s.radius + 0.5 * kThickness),
        half_length_(0.5 * s.wrap * mean_radius_ + s.tail),
        layer_(mechanics::make_rectangle({-half_length_, half_length_}, {0, s.width}, s.h), nullptr, kThickness,
               kDensity, Vector3::Zero()) {
    scene::Layer belt;
    belt.name = "belt";
    belt.thickness = kThickness;
    belt.density = kDensity;
    belt.bending = {0, 0};
    scene::WovenLaw law;
    law.variant = scene::Variant::Uncoupled;
    law.a = {0, 0};
    law.b = {0.5 * kStiffness, 0.5 * kStiffness};
    belt.law = law;
    layer_.mechanics = std::make_unique<fabric::FabricLayer>(belt, 1.0, layer_.mesh);
    drum_ = {.name = "drum", .shape = std::make_unique<Drum>(s.radius)};
    NodalVectors x(3, layer_.mesh.n_nodes());
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      const Vector3 place = lay(layer_.mesh.reference(0, i), layer_.mesh.reference(1, i));
      for (int d = 0; d < 3; ++d) x(d, i) = place(d);
    }
    layer_.position = x;
    layer_.geometry.move_to(x);
    layer_.geometry.move_to(x);
    contact_ = std::make_unique<contact::ToolInterface>(
        contact::InterfaceLaw{.stiffness = 2000, .tangential = 2000, .friction = s.friction}, layer_.geometry, drum_);
    contact_->update(0);
  }

  /// Increment, s: below the limits of the ply (0.17 us h/mm) and of contact (0.7 us).
  double dt() const { return std::min(1e-7 * setup_.h, 4e-7); }
  /// One step: tension at the slack end, the other end loaded the same or moved at `speed` > 0, mm/s.
  /// Dashpots of `damping` (1/s) act between the belt and a frame that slides along its path at `speed`, so that they
  /// settle waves and cost a steady belt no tension.
  void step(double tension, double speed, double damping) {
    const double dt = this->dt();
    time_ += dt;
    layer_.drift(dt);
    contact_->update(dt);
    force_ = contact_->force_on_layer();
    const Vector3 out = tangent();
    for (Eigen::Index i = 0; i < force_.cols(); ++i) {
      const double s = layer_.mesh.reference(0, i);
      if (std::abs(std::abs(s) - half_length_) > 1e-9) continue;
      const double share = end_share(i) * setup_.width * tension;
      const Vector3 along(s < 0 ? -out.x() : out.x(), 0, out.z());
      mechanics::add_at(force_, i, share * along);
    }
    layer_.motion.dt = dt;
    layer_.kick(dt, time_, force_);
    for (Eigen::Index i = 0; i < force_.cols(); ++i) {
      const Vector3 along = speed * direction_at(i);
      for (int d = 0; d < 3; ++d)
        layer_.motion.velocity(d, i) -= damping * dt * (layer_.motion.velocity(d, i) - along(d));
    }
    layer_.motion.velocity.row(1).setZero();  // a wide belt does not contract
    if (speed > 0)
      for (Eigen::Index i = 0; i < force_.cols(); ++i)
        if (layer_.mesh.reference(0, i) > half_length_ - 1e-9)
          for (int d = 0; d < 3; ++d) layer_.motion.velocity(d, i) = speed * out(d);
  }

  /// Mean tension per width of the straight tail on one side, from the strain of its length, N/mm.
  double tension_of_tail(int side) const {
    double strain = 0;
    int n = 0;
    const double from = half_length_ - 0.75 * setup_.tail, to = half_length_ - 0.2 * setup_.tail;
    const mechanics::TriangleMesh& mesh = layer_.mesh;
    for (Eigen::Index e = 0; e < mesh.n_elements(); ++e)
      for (int k = 0; k < 3; ++k) {
        const int i = mesh.triangles(k, e), j = mesh.triangles((k + 1) % 3, e);
        const double s = 0.5 * side * (mesh.reference(0, i) + mesh.reference(0, j));
        const double rest = std::abs(mesh.reference(0, i) - mesh.reference(0, j));
        if (mesh.reference(1, i) != mesh.reference(1, j) || s < from || s > to) continue;
        strain += (mechanics::at(layer_.position, i) - mechanics::at(layer_.position, j)).norm() / rest - 1;
        ++n;
      }
    return kThickness * kStiffness * strain / n;
  }
  /// Pressure of the belt within `angle` (rad) of the top, per midsurface area, each value the mean of a triangle's
  /// nodes: MPa. Single nodes scatter, for a tight triangulated belt loads nodes with four and with eight triangles
  /// alike (services/contact/THEORY.md 4).
  struct Pressure {
    double mean = 0, least = 1e300, largest = 0;
  };
  Pressure pressure(double angle) const {
    Pressure p;
    int n = 0;
    for (Eigen::Index e = 0; e < layer_.mesh.n_elements(); ++e) {
      double value = 0, farthest = 0;
      for (int k = 0; k < 3; ++k) {
        value += contact_->points().pressure(layer_.mesh.triangles(k, e)) / 3;
        farthest = std::max(farthest, std::abs(layer_.mesh.reference(0, layer_.mesh.triangles(k, e))));
      }
      if (farthest > angle * mean_radius_) continue;
      p.mean += value;
      p.least = std::min(p.least, value);
      p.largest = std::max(p.largest, value);
      ++n;
    }
    p.mean /= n;
    return p;
  }
  double mean_radius() const { return mean_radius_; }
  double wrap() const { return setup_.wrap; }
  const contact::ToolInterface& contact() const { return *contact_; }
  double kinetic() const { return layer_.motion.kinetic; }

 private:
  /// Where arc length s lies: on the circle of the midsurface, or on its tangent beyond.
  Vector3 lay(double s, double y) const {
    const double most = 0.5 * setup_.wrap, angle = std::clamp(s / mean_radius_, -most, most);
    const double beyond = s - angle * mean_radius_;
    return {mean_radius_ * std::sin(angle) + beyond * std::cos(angle), y,
            mean_radius_ * std::cos(angle) - beyond * std::sin(angle)};
  }
  Vector3 tangent() const { return {std::cos(0.5 * setup_.wrap), 0, -std::sin(0.5 * setup_.wrap)}; }
  /// Of the belt's path at node i.
  Vector3 direction_at(Eigen::Index i) const {
    const double most = 0.5 * setup_.wrap;
    const double angle = std::clamp(std::atan2(layer_.position(0, i), layer_.position(2, i)), -most, most);
    return {std::cos(angle), 0, -std::sin(angle)};
  }
  /// Share of the width that an end node stands for.
  double end_share(Eigen::Index i) const {
    const double y = layer_.mesh.reference(1, i);
    const double cells = std::max(1.0, std::round(setup_.width / setup_.h));
    return (y < 1e-9 || y > setup_.width - 1e-9 ? 0.5 : 1.0) / cells;
  }

  Setup setup_;
  double mean_radius_, half_length_;
  FreeLayer layer_;
  contact::Tool drum_;
  std::unique_ptr<contact::ToolInterface> contact_;
  NodalVectors force_;
  double time_ = 0;
};

}  // namespace interply::test
