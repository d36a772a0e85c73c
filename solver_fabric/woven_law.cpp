#include "solver_fabric/woven_law.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace interply::fabric {

double compute_smallest_eigenvalue(const Potential& w) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(w.hessian(), Eigen::EigenvaluesOnly).eigenvalues()(0);
}

InvariantLaw::InvariantLaw(const scene::WovenLaw& law)
    : p_{.warp = {law.a.warp, law.b.warp, law.c.warp, law.p_min.warp, law.d.warp, law.s_T.warp, law.s_C.warp,
                  law.strain_cap.warp},
         .weft = {law.a.weft, law.b.weft, law.c.weft, law.p_min.weft, law.d.weft, law.s_T.weft, law.s_C.weft,
                  law.strain_cap.weft},
         .s = {law.s[0], law.s[1], law.s[2]}} {
  const bool biaxial = law.variant == scene::Variant::Full || law.variant == scene::Variant::Biaxial;
  const bool normal_shear = law.variant == scene::Variant::Full || law.variant == scene::Variant::NormalShear;
  for (FibreParameters* p : {&p_.warp, &p_.weft}) {
    if (!biaxial) {
      p->c = 0;
      p->p_min = 1;
      p->strain_cap = std::numeric_limits<double>::infinity();
    }
    if (!normal_shear) p->s_T = p->s_C = 0;
  }
}

PiecewiseLinear::PiecewiseLinear(const scene::Table& table) {
  if (table.size() < 2) throw std::invalid_argument("a table of variant fabric needs at least two points");
  for (const auto& [x, value] : table) {
    if (!x_.empty() && !(x > x_.back()))
      throw std::invalid_argument("the first column of a table of variant fabric must ascend strictly");
    const double before = x_.empty() ? 0 : integral_.back() + (x - x_.back()) * (value + value_.back()) / 2;
    x_.push_back(x);
    value_.push_back(value);
    integral_.push_back(before);
  }
  const double at_zero = evaluate(0).f;
  for (double& f : integral_) f -= at_zero;
}

std::size_t PiecewiseLinear::find_segment(double x) const {
  const auto above = std::upper_bound(x_.begin() + 1, x_.end() - 1, x);
  return static_cast<std::size_t>(above - x_.begin()) - 1;
}

Jet PiecewiseLinear::evaluate(double x) const {
  const std::size_t i = find_segment(x);
  const double slope = (value_[i + 1] - value_[i]) / (x_[i + 1] - x_[i]), t = x - x_[i];
  return {integral_[i] + t * (value_[i] + slope * t / 2), value_[i] + slope * t, slope};
}

TableLaw::TableLaw(const scene::FabricTables& tables) : warp_(tables.warp), weft_(tables.weft), shear_(tables.shear) {
  const auto steeper_side = [](const PiecewiseLinear& t) {
    const double step = std::numeric_limits<double>::min();  // picks the segment on each side of zero
    return std::max(t.evaluate(-step).dd, t.evaluate(step).dd);
  };
  floor_ = {steeper_side(warp_), steeper_side(weft_)};
}

scene::FabricTables sample_tables(const scene::WovenLaw& law, int tension_segments, int shear_segments) {
  scene::WovenLaw uncoupled = law;
  uncoupled.variant = scene::Variant::Uncoupled;
  const InvariantLaw source(uncoupled);
  scene::FabricTables t;
  t.warp.push_back({-1, -2 * law.d.warp});
  t.weft.push_back({-1, -2 * law.d.weft});
  for (int i = 0; i <= tension_segments; ++i) {
    const double e = 0.25 * i / tension_segments;
    t.warp.push_back({e, source.evaluate(1 + e, 1, 0).W_a});
    t.weft.push_back({e, source.evaluate(1, 1 + e, 0).W_b});
  }
  for (int i = 0; i <= shear_segments; ++i) {
    const double g = std::numbers::pi / 2 * i / shear_segments;
    t.shear.push_back({g, source.evaluate(1, 1, g).tau});
  }
  return t;
}

MembraneLaw make_membrane_law(const scene::WovenLaw& law) {
  if (law.variant != scene::Variant::Fabric) return InvariantLaw(law);
  return TableLaw(law.tables ? *law.tables : sample_tables(law));
}

}  // namespace interply::fabric
