#include "solver_fabric/material_point.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>

#include "solver_fabric/membrane.hpp"

namespace interply::fabric {

using mechanics::Vector3;

namespace {

FibreState<double> compute_fibres(const Vector3& f_a, const Vector3& f_b, double area_ratio) {
  return compute_fibre_state<double>(
      {.f1 = {f_a.x(), f_a.y(), f_a.z()}, .f2 = {f_b.x(), f_b.y(), f_b.z()}, .t3 = {}, .area_ratio = area_ratio});
}

double compute_smallest_eigenvalue(const Potential<double>& w) {
  Eigen::Matrix3d hessian;
  hessian << w.W_aa, w.W_ab, w.W_ag, w.W_ab, w.W_bb, w.W_bg, w.W_ag, w.W_bg, w.W_gg;
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(hessian, Eigen::EigenvaluesOnly).eigenvalues()(0);
}

}  // namespace

FabricPoint compute_deformation(const Vector3& f_a, const Vector3& f_b, double area_ratio) {
  const FibreState<double> s = compute_fibres(f_a, f_b, area_ratio);
  return {
      .I4 = f_a.squaredNorm(), .I8 = f_b.squaredNorm(), .gamma = s.gamma, .la = s.la, .lb = s.lb, .cosine = s.cosine};
}

FabricPoint evaluate_point(const MembraneLaw& law, const Vector3& f_a, const Vector3& f_b, double area_ratio) {
  const FibreState<double> s = compute_fibres(f_a, f_b, area_ratio);
  const Potential<double> w = evaluate(law, s.la, s.lb, s.gamma);
  const MembraneStress<double> S = compute_membrane_stress(w, s);
  FabricPoint p = compute_deformation(f_a, f_b, area_ratio);
  p.W = w.W;
  p.S11 = S.S11;
  p.S22 = S.S22;
  p.S12 = S.S12;
  p.smallest_eigenvalue = compute_smallest_eigenvalue(w);
  return p;
}

FabricPoint evaluate_point(const MembraneLaw& law, const mechanics::Matrix2& F) {
  return evaluate_point(law, {F(0, 0), F(1, 0), 0}, {F(0, 1), F(1, 1), 0}, F.determinant());
}

std::vector<FabricPoint> follow_path(const scene::WovenLaw& law, const std::vector<mechanics::Matrix2>& path) {
  const MembraneLaw membrane = make_membrane_law(law);
  std::vector<FabricPoint> points;
  points.reserve(path.size());
  for (const auto& F : path) points.push_back(evaluate_point(membrane, F));
  return points;
}

}  // namespace interply::fabric
