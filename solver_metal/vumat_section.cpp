#include "solver_metal/vumat_section.hpp"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace interply::metal {

namespace {

mechanics::Matrix2 to_matrix(const Symmetric2& a) {
  mechanics::Matrix2 m;
  m << a.m11, a.m12, a.m12, a.m22;
  return m;
}

double compute_isotropic_bound(const Eigen::Matrix3d& tangent) {
  const Eigen::DiagonalMatrix<double, 3> t(1, 1, std::sqrt(2.0));
  const Eigen::Matrix3d scaled = t * tangent * t;
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(scaled, Eigen::EigenvaluesOnly);
  return solver.eigenvalues()(2);
}

}  // namespace

VumatSection::VumatSection(const scene::Layer& layer, const ThicknessRule& rule, const mechanics::TriangleMesh& mesh)
    : name_(layer.name),
      rule_(rule),
      nodes_(mesh.triangles),
      area_(mechanics::compute_areas(mesh)),
      points_(std::get<scene::VumatLaw>(layer.law), layer.name, layer.density, mesh.n_elements(), rule.size()),
      increments_(static_cast<std::size_t>(points_.size())),
      old_thickness_(static_cast<std::size_t>(points_.size()), 1.0) {
  for (auto& increment : increments_) increment.stretch.setIdentity();
  begin(mesh.reference, {});
}

void VumatSection::begin(const mechanics::NodalVectors& position, const solve::Instant& now) {
  now_ = now;
  for (Eigen::Index e = 0; e < area_.size(); ++e) {
    mechanics::Vector3 centre = mechanics::Vector3::Zero();
    for (int k = 0; k < 3; ++k) centre += mechanics::at(position, nodes_(k, e)) / 3;
    for (int i = 0; i < rule_.size(); ++i) {
      auto& at = increments_[static_cast<std::size_t>(point(e, i))];
      at.position = centre;
      at.length = std::sqrt(area_(e) * at.stretch.determinant());
    }
  }
}

void VumatSection::set_increment(Eigen::Index e, const ElementShape& now, const StrainIncrement& de,
                                 double thickness) {
  for (int i = 0; i < rule_.size(); ++i) {
    const double xi = rule_.point[static_cast<std::size_t>(i)], z = 0.5 * thickness * xi;
    const Eigen::Index p = point(e, i);
    auto& at = increments_[static_cast<std::size_t>(p)];
    const mechanics::Matrix2 metric = to_matrix(now.metric - (2 * z) * now.curvature);
    auto increment = solve::compute_vumat_increment(points_.stretch(p), metric);
    increment.strain = to_matrix(de.membrane + xi * de.bending);
    increment.position = at.position;
    increment.length = at.length;
    at = increment;
    old_thickness_[static_cast<std::size_t>(p)] = points_.response(p).thickness_stretch;
  }
}

void VumatSection::advance(Eigen::Index begin, Eigen::Index end) {
  const int n = static_cast<int>(end - begin);
  for (int i = 0; i < rule_.size(); ++i) {
    const Eigen::Index first = point(begin, i);
    const auto* increments = &increments_[static_cast<std::size_t>(first)];
    is_still() ? points_.rehearse(first, n, increments, now_) : points_.advance(first, n, increments, now_);
  }
}

double VumatSection::take(Eigen::Index e, int i, Symmetric2& stress) const {
  const Eigen::Index p = point(e, i);
  const auto [sigma, thickness] = points_.response(p);
  stress = {sigma(0, 0), sigma(1, 1), sigma(0, 1)};
  if (!sigma.allFinite()) return NAN;
  return std::log(thickness / old_thickness_[static_cast<std::size_t>(p)]);
}

double VumatSection::initial_modulus_bound() const { return compute_isotropic_bound(points_.initial_tangent()); }

double VumatSection::compute_modulus_bound() {
  double bound = initial_modulus_bound();
  std::vector<Eigen::Matrix3d> tangents(solve::kVumatBlock);
  const Eigen::Index n_elements = area_.size();
  for (int i = 0; i < rule_.size(); ++i) {
    for (Eigen::Index begin = 0; begin < n_elements; begin += solve::kVumatBlock) {
      const int n = static_cast<int>(std::min<Eigen::Index>(solve::kVumatBlock, n_elements - begin));
      const Eigen::Index first = point(begin, i);
      points_.compute_tangents(first, n, &increments_[static_cast<std::size_t>(first)], now_, tangents.data());
      for (int k = 0; k < n; ++k) {
        const Eigen::Matrix3d& tangent = tangents[static_cast<std::size_t>(k)];
        if (!tangent.allFinite())
          throw mechanics::Divergence(fmt::format(
              "layer {}, element {}, t = {:.6g} s: the vumat answers small strains with stiffnesses that are not "
              "finite; check law.vumat.parameters, or lower time.safety",
              name_, begin + k, now_.time));
        bound = std::max(bound, compute_isotropic_bound(tangent));
      }
    }
  }
  return bound;
}

void VumatSection::add_fields(std::vector<observe::Field>& fields) const {
  const int low = (rule_.size() - 1) / 2, high = rule_.size() / 2;  // equal for an odd number of points
  for (int v = 0; v < points_.n_state(); ++v) {
    observe::Field field{.name = fmt::format("state_{}", v + 1),
                         .unit = "-",
                         .description = "state variable of the vumat at the midsurface, in its own unit",
                         .values = {}};
    for (Eigen::Index e = 0; e < area_.size(); ++e)
      field.values.push_back(0.5 * (points_.state(v, point(e, low)) + points_.state(v, point(e, high))));
    fields.push_back(std::move(field));
  }
}

}  // namespace interply::metal
