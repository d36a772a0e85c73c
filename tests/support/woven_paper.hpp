/// The equations of the woven ply written out as printed, and the stress and forces that follow from them by complex
/// steps. The tests measure the law of solver_fabric against these, so nothing here comes from there.
#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <array>
#include <cmath>
#include <complex>

#include "mechanics/mesh.hpp"
#include "scene/scene.hpp"

namespace interply::woven_paper {

using Complex = std::complex<double>;
inline constexpr double kStep = 1e-30;  ///< f'(x) = Im f(x + i step)/step, exact to round-off

/// Integral of a table from 0 to x, straight on beyond both ends, by the trapezium rule between its points.
template <class T>
T integrate(const scene::Table& table, const T& x) {
  const auto value = [&](const auto& at) {
    std::size_t i = 0;
    while (i + 2 < table.size() && std::real(at) >= table[i + 1][0]) ++i;
    const auto &p = table[i], &q = table[i + 1];
    return p[1] + (at - p[0]) * ((q[1] - p[1]) / (q[0] - p[0]));
  };
  const double end = std::real(x);
  double from = 0;
  T sum = 0.0;
  const auto go_to = [&](double to) {
    sum += (value(from) + value(to)) / 2 * (to - from);
    from = to;
  };
  for (std::size_t i = 0; i < table.size(); ++i) {
    const double up = table[i][0], down = table[table.size() - 1 - i][0];
    if (end > 0 && up > 0 && up < end) go_to(up);
    if (end < 0 && down < 0 && down > end) go_to(down);
  }
  return sum + (value(from) + value(x)) / 2.0 * (x - from);
}

/// W of eq. (1)-(11) case by case in the invariants, with exp for "exp exp", |I10|, and strain_cap; of variant `fabric`
/// the sum of the integrals of its tables, which must be given. MPa
template <class T>
T compute_energy(const scene::WovenLaw& law, const T& I4, const T& I8, const T& I10) {
  using scene::Variant;
  using std::exp, std::sqrt, std::real;
  const bool shear = law.variant == Variant::Full || law.variant == Variant::NormalShear;
  const bool biaxial = law.variant == Variant::Full || law.variant == Variant::Biaxial;
  const T ea = sqrt(I4) - 1.0, eb = sqrt(I8) - 1.0, g = real(I10) < 0 ? -I10 : I10;
  if (law.variant == Variant::Fabric)
    return integrate(law.tables.value().warp, ea) + integrate(law.tables.value().weft, eb) +
           integrate(law.tables.value().shear, g);
  const auto tension = [](double a, double b, const T& e) { return a * e * e * e + b * e * e; };
  const auto capped_exp = [](double c, const T& e, double cap) -> T {
    return real(e) <= cap ? exp(c * e) : exp(c * cap) * (1.0 + c * (e - cap));
  };
  const T xa = capped_exp(law.c.warp, eb, law.strain_cap.warp), xb = capped_exp(law.c.weft, ea, law.strain_cap.weft);
  const T ka = biaxial ? xa + law.p_min.warp * (1.0 - xa) : T(1.0),
          kb = biaxial ? xb + law.p_min.weft * (1.0 - xb) : T(1.0);
  const T WTa = tension(law.a.warp, law.b.warp, ea) * ka, WTb = tension(law.a.weft, law.b.weft, eb) * kb;
  const T WCa = law.d.warp * ea * ea, WCb = law.d.weft * eb * eb;
  const T WS = law.s[0] * g * g / 2.0 + law.s[1] * g * g * g / 3.0 + law.s[2] * g * g * g * g / 4.0;
  const T ua = I4 - 1.0, ub = I8 - 1.0;
  const T WSTa = (shear ? law.s_T.warp : 0.0) * g * g * g / 3.0 * ua * ua;
  const T WSTb = (shear ? law.s_T.weft : 0.0) * g * g * g / 3.0 * ub * ub;
  const T kSCa = exp((shear ? law.s_C.warp : 0.0) * ua * ua * ua),
          kSCb = exp((shear ? law.s_C.weft : 0.0) * ub * ub * ub);
  if (real(I4) > 1 && real(I8) > 1) return WTa + WTb + WS + WSTa + WSTb;
  if (real(I4) > 1) return WTa + WCb + (WS + WSTa) * kSCb;
  if (real(I8) > 1) return WCa + WTb + (WS + WSTb) * kSCa;
  return WCa + WCb + WS * kSCa * kSCb;
}

/// (dW/dla, dW/dlb, dW/dgamma), MPa.
inline Eigen::Vector3d compute_gradient(const scene::WovenLaw& law, const Eigen::Vector3d& la_lb_gamma) {
  Eigen::Vector3d gradient;
  for (int i = 0; i < 3; ++i) {
    Eigen::Vector3cd q = la_lb_gamma.cast<Complex>();
    q(i) += Complex(0, kStep);
    gradient(i) = compute_energy<Complex>(law, q(0) * q(0), q(1) * q(1), q(2)).imag() / kStep;
  }
  return gradient;
}

/// Second derivatives of W in (la, lb, gamma), MPa, by differences of sixth order. @pre no corner within 3 h
inline Eigen::Matrix3d compute_hessian(const scene::WovenLaw& law, const Eigen::Vector3d& la_lb_gamma,
                                       double h = 1e-4) {
  Eigen::Matrix3d H;
  for (int i = 0; i < 3; ++i) {
    const auto between = [&](int n) -> Eigen::Vector3d {
      const Eigen::Vector3d step = n * h * Eigen::Vector3d::Unit(i);
      return compute_gradient(law, la_lb_gamma + step) - compute_gradient(law, la_lb_gamma - step);
    };
    H.col(i) = (45 * between(1) - 9 * between(2) + between(3)) / (60 * h);
  }
  return H;
}

/// Second Piola-Kirchhoff stress in the fibre frame, S = 2 dW/dC with I4 = C11, I8 = C22, sin I10 = C12/sqrt(C11 C22).
/// [2 x 2] MPa
inline Eigen::Matrix2d compute_stress(const scene::WovenLaw& law, const Eigen::Matrix2d& C) {
  const auto differentiate = [&](int i, int j) {
    Eigen::Matrix2cd c = C.cast<Complex>();
    c(i, j) += Complex(0, kStep);
    return compute_energy<Complex>(law, c(0, 0), c(1, 1), std::asin(c(0, 1) / std::sqrt(c(0, 0) * c(1, 1)))).imag() /
           kStep;
  };
  Eigen::Matrix2d S;
  S << 2 * differentiate(0, 0), differentiate(0, 1), differentiate(0, 1), 2 * differentiate(1, 1);
  return S;
}

/// Constant-strain triangle: its corners, and the fibre directions in its plane of reference.
struct Triangle {
  Eigen::Matrix2d fibres;  ///< a0, b0 in the basis of the sides X1 - X0, X2 - X0
  double area;             ///< reference, mm2

  /// @param reference  columns: corners, mm  @param angle  of the warp from x, rad
  Triangle(const Eigen::Matrix<double, 2, 3>& reference, double angle) {
    Eigen::Matrix2d sides, directions;
    sides << reference.col(1) - reference.col(0), reference.col(2) - reference.col(0);
    directions << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
    fibres = sides.inverse() * directions;
    area = sides.determinant() / 2;
  }
  /// sum_k grad N_k (x) grad N_k in the fibre frame. [2 x 2] 1/mm2
  Eigen::Matrix2d compute_gradient_products() const {
    Eigen::Matrix<double, 2, 3> n;
    n << -fibres.transpose().rowwise().sum(), fibres.transpose();
    return n * n.transpose();
  }
  /// (la, lb, gamma). @param x  columns: current corners, mm
  Eigen::Vector3cd compute_state(const Eigen::Matrix3cd& x) const {
    const Eigen::Vector3cd u = x.col(1) - x.col(0), v = x.col(2) - x.col(0);
    const Eigen::Vector3cd a = fibres(0, 0) * u + fibres(1, 0) * v, b = fibres(0, 1) * u + fibres(1, 1) * v;
    // not Eigen's dot product, which conjugates
    const Complex aa = (a.transpose() * a).value(), bb = (b.transpose() * b).value(), ab = (a.transpose() * b).value();
    return {std::sqrt(aa), std::sqrt(bb), std::asin(ab / std::sqrt(aa * bb))};
  }
  /// Derivatives of (la, lb, gamma) by the coordinates of the corners. [3 x 9] 1/mm, -
  Eigen::Matrix<double, 3, 9> compute_kinematics(const Eigen::Matrix3d& x) const {
    Eigen::Matrix<double, 3, 9> B;
    for (int i = 0; i < 9; ++i) {
      Eigen::Matrix3cd moved = x.cast<Complex>();
      moved(i) += Complex(0, kStep);
      B.col(i) = compute_state(moved).imag() / kStep;
    }
    return B;
  }
};

}  // namespace interply::woven_paper
