#include "solver_fabric/vumat_membrane.hpp"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

namespace interply::fabric {

using mechanics::Matrix2;

namespace {

/// sum_k grad N_k (x) grad N_k of element `e`, 1/mm2.
Matrix2 compute_gradient_products(const mechanics::ShellGeometry& shell, Eigen::Index e) {
  Matrix2 g = Matrix2::Zero();
  for (int k = 0; k < 3; ++k) {
    const mechanics::Vector2 n(shell.gradient(2 * k, e), shell.gradient(2 * k + 1, e));
    g += n * n.transpose();
  }
  return g;
}

/// Of a matrix with real eigenvalues.
double compute_largest_eigenvalue(const Matrix2& m) {
  const double half = m.trace() / 2;
  return half + std::sqrt(std::max(0.0, half * half - m.determinant()));
}

}  // namespace

VumatMembrane::VumatMembrane(const scene::Layer& layer, const mechanics::ShellGeometry& shell,
                             const mechanics::NodalVectors& reference)
    : name_(layer.name),
      shell_(shell),
      points_(std::get<scene::VumatLaw>(layer.law), layer.name, layer.density, shell.n_elements()),
      stress_(decltype(stress_)::Zero(3, shell.n_elements())),
      energy_(mechanics::Scalars::Zero(shell.n_elements())),
      increments_(static_cast<std::size_t>(shell.n_elements())),
      tangents_(solve::kVumatBlock) {
  for (Eigen::Index e = 0; e < points_.size(); ++e) {
    increments_[static_cast<std::size_t>(e)].stretch.setIdentity();
    set_place(e, reference);
  }
}

/// Where the point is: what a law may ask for beside its strain.
void VumatMembrane::set_place(Eigen::Index e, const mechanics::NodalVectors& position) {
  auto& at = increments_[static_cast<std::size_t>(e)];
  at.length = std::sqrt(shell_.area(e) * at.stretch.determinant());
  at.position.setZero();
  for (int k = 0; k < 3; ++k) at.position += mechanics::at(position, shell_.nodes(k, e)) / 3;
}

Eigen::Index VumatMembrane::advance(const mechanics::NodalVectors& f1, const mechanics::NodalVectors& f2,
                                    const mechanics::NodalVectors& position, const solve::Instant& now) {
  now_ = now;
  std::array<Matrix2, solve::kVumatBlock> old_stretch;
  for (Eigen::Index first = 0; first < points_.size(); first += solve::kVumatBlock) {
    const int n = static_cast<int>(std::min<Eigen::Index>(solve::kVumatBlock, points_.size() - first));
    auto* increments = &increments_[static_cast<std::size_t>(first)];
    for (int i = 0; i < n; ++i) {
      const Eigen::Index e = first + i;
      const mechanics::Vector3 a = mechanics::at(f1, e), b = mechanics::at(f2, e);
      Matrix2 metric;
      metric << a.dot(a), a.dot(b), a.dot(b), b.dot(b);
      Matrix2& old = old_stretch[static_cast<std::size_t>(i)];
      old = points_.stretch(e);
      increments[i] = solve::compute_vumat_increment(old, metric);
      set_place(e, position);
    }
    if (now.dt == 0) {
      points_.rehearse(first, n, increments, now);
      continue;
    }
    points_.advance(first, n, increments, now);
    for (int i = 0; i < n; ++i) update_stress(first + i, old_stretch[static_cast<std::size_t>(i)]);
  }
  for (Eigen::Index e = 0; e < points_.size(); ++e)
    if (!std::isfinite(energy_(e)) || !(points_.response(e).thickness_stretch > 0)) return e;
  return -1;
}

void VumatMembrane::update_stress(Eigen::Index e, const Matrix2& old_stretch) {
  const Matrix2 u = points_.stretch(e), inverse = u.inverse();
  const auto [sigma, thickness] = points_.response(e);
  const Matrix2 s = u.determinant() * thickness * (inverse * sigma * inverse);
  const Matrix2 de = (u * u - old_stretch * old_stretch) / 2;
  const mechanics::Vector3 old = stress(e);
  stress_.col(e) << s(0, 0), s(1, 1), s(0, 1);
  energy_(e) += ((old(0) + s(0, 0)) * de(0, 0) + (old(1) + s(1, 1)) * de(1, 1)) / 2 + (old(2) + s(0, 1)) * de(0, 1);
}

double VumatMembrane::compute_eigenvalue_bound() {
  double bound = 0;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  const auto largest = [&](const Eigen::Matrix3d& d, const Eigen::Matrix3d& l) {
    solver.computeDirect((l.transpose() * d * l).eval(), Eigen::EigenvaluesOnly);  // lambda(D Q) = lambda(L' D L)
    return solver.eigenvalues()(2);
  };
  for (Eigen::Index first = 0; first < points_.size(); first += solve::kVumatBlock) {
    const int n = static_cast<int>(std::min<Eigen::Index>(solve::kVumatBlock, points_.size() - first));
    points_.compute_tangents(first, n, &increments_[static_cast<std::size_t>(first)], now_, tangents_.data());
    for (int i = 0; i < n; ++i) {
      const Eigen::Index e = first + i;
      const Matrix2 u = points_.stretch(e), inverse = u.inverse();
      const Matrix2 g = inverse * compute_gradient_products(shell_, e) * inverse;
      Eigen::Matrix3d q;
      q << g(0, 0), 0, g(0, 1), 0, g(1, 1), g(0, 1), g(0, 1), g(0, 1), g(0, 0) + g(1, 1);
      const Eigen::Matrix3d l = q.llt().matrixL();
      const auto [sigma, thickness] = points_.response(e);
      const double principal = std::abs(sigma.trace() / 2) + std::hypot((sigma(0, 0) - sigma(1, 1)) / 2, sigma(0, 1));
      const double stiffness =
          std::max(largest(tangents_[static_cast<std::size_t>(i)], l), largest(points_.initial_tangent(), l));
      const double own = u.determinant() * thickness * (stiffness + 3 * principal * compute_largest_eigenvalue(g));
      if (!std::isfinite(own))
        throw mechanics::Divergence(fmt::format(
            "layer {}, element {}, t = {:.6g} s: the vumat answers small strains with stiffnesses that are not finite; "
            "check law.vumat.parameters, or lower time.safety",
            name_, e, now_.time));
      bound = std::max(bound, own);
    }
  }
  return bound;
}

mechanics::Scalars VumatMembrane::compute_nodal_thickness_stretch() const {
  const auto& gather = shell_.gather;
  const auto n_nodes = static_cast<Eigen::Index>(gather.start.size()) - 1;
  mechanics::Scalars stretch(n_nodes);
  for (Eigen::Index node = 0; node < n_nodes; ++node) {
    double volume = 0, area = 0;
    for (int i = gather.start[node]; i < gather.start[node + 1]; ++i) {
      const Eigen::Index e = gather.entry[i] % points_.size();
      volume += shell_.area(e) * points_.response(e).thickness_stretch;
      area += shell_.area(e);
    }
    stretch(node) = area > 0 ? volume / area : 1;
  }
  return stretch;
}

void VumatMembrane::add_fields(std::vector<observe::Field>& fields) const {
  const auto add = [&](const std::string& name, const char* description, const auto& value) {
    observe::Field field{.name = name, .unit = "-", .description = description, .values = {}};
    for (Eigen::Index e = 0; e < points_.size(); ++e) field.values.push_back(value(e));
    fields.push_back(std::move(field));
  };
  add("thickness_stretch", "current / reference thickness",
      [&](Eigen::Index e) { return points_.response(e).thickness_stretch; });
  for (int i = 0; i < points_.n_state(); ++i)
    add(fmt::format("state_{}", i + 1), "state variable of the vumat, in its own unit",
        [&](Eigen::Index e) { return points_.state(i, e); });
}

std::string VumatMembrane::describe_response(Eigen::Index e) const {
  const auto [sigma, thickness] = points_.response(e);
  return fmt::format(
      "the vumat returned the stress ({:.4g}, {:.4g}, {:.4g}) MPa (11, 22, 12) and the thickness "
      "stretch {:.4g}",
      sigma(0, 0), sigma(1, 1), sigma(0, 1), thickness);
}

}  // namespace interply::fabric
