#include "solver_metal/law_constants.hpp"

#include "solver_metal/hill48.hpp"

namespace interply::metal {

namespace {

CurveConstants to_constants(const scene::Swift& h) {
  return {.curve = Curve::Swift, .strength = h.K, .offset = h.e0, .exponent = h.n};
}
CurveConstants to_constants(const scene::Voce& h) {
  return {.curve = Curve::Voce, .strength = h.s_inf, .start = h.s0, .rate = h.rate};
}
CurveConstants to_constants(const scene::HockettSherby& h) {
  return {.curve = Curve::HockettSherby, .strength = h.s_inf, .start = h.s0, .rate = h.rate, .exponent = h.n};
}
CurveConstants to_constants(const scene::HardeningTable& h) {
  return {.curve = Curve::Table, .points = h.points.data()->data(), .n_points = static_cast<int>(h.points.size())};
}

}  // namespace

LawConstants make_law_constants(const J2Constants& j2, const Hill48Constants* hill48) {
  LawConstants law{.young = j2.young,
                   .poisson = j2.poisson,
                   .sum_modulus = j2.sum_modulus,
                   .twice_shear = j2.twice_shear,
                   .curve = std::visit([](const auto& h) { return to_constants(h); }, j2.hardening),
                   .j2 = &j2,
                   .hill48 = hill48};
  if (!hill48) return law;
  law.h = hill48->coefficients.h;
  law.p = hill48->coefficients.p;
  law.q = hill48->coefficients.q;
  for (int i = 0; i < 3; ++i) law.rate[i] = hill48->rate[static_cast<std::size_t>(i)];
  for (int i = 0; i < 2; ++i)
    for (int j = 0; j < 2; ++j) {
      law.to_mode[i][j] = hill48->to_mode[i][j];
      law.from_mode[i][j] = hill48->from_mode[i][j];
    }
  law.shear_root = hill48->shear_root;
  return law;
}

PlasticPoint return_to_yield_surface(const LawConstants& law, const double* square, PlasticPoint point) {
  J2Point at{{}, point.plastic_strain, {point.yield_stress, point.yield_slope}};
  point.multiplier = law.hill48 ? update_plastic_strain(*law.hill48, {square[0], square[1], square[2]}, at)
                                : update_plastic_strain(*law.j2, square[0], square[1], at);
  point.plastic_strain = at.plastic_strain;
  point.yield_stress = at.yield.stress;
  point.yield_slope = at.yield.slope;
  return point;
}

}  // namespace interply::metal
