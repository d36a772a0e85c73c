#include "solver_fabric/membrane_law.hpp"

#include <algorithm>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "solver_fabric/woven_law.hpp"

namespace interply::fabric {
namespace {

InvariantLaw make_invariant_law(const scene::WovenLaw& law, scene::Variant variant) {
  InvariantLaw l{.warp = {law.a.warp, law.b.warp, law.c.warp, law.p_min.warp, law.d.warp, law.s_T.warp, law.s_C.warp,
                          law.strain_cap.warp},
                 .weft = {law.a.weft, law.b.weft, law.c.weft, law.p_min.weft, law.d.weft, law.s_T.weft, law.s_C.weft,
                          law.strain_cap.weft},
                 .s = {law.s[0], law.s[1], law.s[2]},
                 .stiffness_floor = {2 * std::max(law.b.warp, law.d.warp), 2 * std::max(law.b.weft, law.d.weft)}};
  const bool biaxial = variant == scene::Variant::Full || variant == scene::Variant::Biaxial;
  const bool normal_shear = variant == scene::Variant::Full || variant == scene::Variant::NormalShear;
  for (FibreParameters* p : {&l.warp, &l.weft}) {
    if (!biaxial) {
      p->c = 0;
      p->p_min = 1;
      p->strain_cap = std::numeric_limits<double>::infinity();
    }
    if (!normal_shear) p->s_T = p->s_C = 0;
  }
  return l;
}

Curve make_curve(const scene::Table& table) {
  if (table.size() < 2) throw std::invalid_argument("a table of variant fabric needs at least two points");
  Curve c;
  for (const auto& [x, value] : table) {
    if (!c.x.empty() && !(x > c.x.back()))
      throw std::invalid_argument("the first column of a table of variant fabric must ascend strictly");
    const double before = c.x.empty() ? 0 : c.integral.back() + (x - c.x.back()) * (value + c.value.back()) / 2;
    c.x.push_back(x);
    c.value.push_back(value);
    c.integral.push_back(before);
  }
  const double at_zero = evaluate(c, 0.0).f;
  for (double& f : c.integral) f -= at_zero;
  return c;
}

TableLaw make_table_law(const scene::FabricTables& tables) {
  const auto steeper_side = [](const Curve& c) {
    const double step = std::numeric_limits<double>::min();  // picks the segment on each side of zero
    return std::max(evaluate(c, -step).dd, evaluate(c, step).dd);
  };
  TableLaw l{make_curve(tables.warp), make_curve(tables.weft), make_curve(tables.shear)};
  l.stiffness_floor[0] = steeper_side(l.warp);
  l.stiffness_floor[1] = steeper_side(l.weft);
  return l;
}

}  // namespace

MembraneLaw make_membrane_law(const scene::WovenLaw& law) {
  if (law.variant != scene::Variant::Fabric) return make_invariant_law(law, law.variant);
  return make_table_law(law.tables ? *law.tables : sample_tables(law));
}

scene::FabricTables sample_tables(const scene::WovenLaw& law, int tension_segments, int shear_segments) {
  const InvariantLaw source = make_invariant_law(law, scene::Variant::Uncoupled);
  scene::FabricTables t;
  t.warp.push_back({-1, -2 * law.d.warp});
  t.weft.push_back({-1, -2 * law.d.weft});
  for (int i = 0; i <= tension_segments; ++i) {
    const double e = 0.25 * i / tension_segments;
    t.warp.push_back({e, evaluate(source, 1 + e, 1.0, 0.0).W_a});
    t.weft.push_back({e, evaluate(source, 1.0, 1 + e, 0.0).W_b});
  }
  for (int i = 0; i <= shear_segments; ++i) {
    const double g = std::numbers::pi / 2 * i / shear_segments;
    t.shear.push_back({g, evaluate(source, 1.0, 1.0, g).tau});
  }
  return t;
}

bool is_beyond_cap(const MembraneLaw& law, double la, double lb) {
  const auto* l = std::get_if<InvariantLaw>(&law);
  return l && ((la > 1 && lb - 1 > l->warp.strain_cap) || (lb > 1 && la - 1 > l->weft.strain_cap));
}

}  // namespace interply::fabric
