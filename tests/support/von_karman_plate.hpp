/// Square plate with clamped edges under uniform pressure: an independent solution of von Karman's equations.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <vector>

namespace interply::test {

/// Ritz with polynomials on [-1, 1]^2, quadrature and Newton's method. Edges: w = 0, normal slope 0, no displacement
/// normal to the edge; along the edge free (the case of Levy, NACA TR 740). Von Karman's equations know t/a only
/// through q a^4/(E t^4), so E = t = 1 and a = 2 here.
class VonKarmanPlate {
 public:
  /// @param poisson
  /// @param n  functions of each displacement and direction; 5 give four digits at w0 = t
  explicit VonKarmanPlate(double poisson, int n = 5) : poisson_(poisson), n_(n) {
    const int points = 16;
    for (int i = 0; i < points; ++i)
      for (int j = 0; j < points; ++j) add_point(gauss(points, i), gauss(points, j));
    z_ = Eigen::VectorXd::Zero(3 * n * n);
  }

  /// Deflection of the centre over the thickness.
  /// @param pressure  q a^4/(E t^4); each call starts from the solution of the one before
  double solve(double pressure) {
    const Eigen::Index m = n_ * n_;
    const double q = pressure / 16, d = 1 / (12 * (1 - poisson_ * poisson_)), c = 1 / (1 - poisson_ * poisson_);
    Eigen::Matrix3d elastic;
    elastic << 1, poisson_, 0, poisson_, 1, 0, 0, 0, (1 - poisson_) / 2;
    for (int iteration = 0; iteration < 30; ++iteration) {
      Eigen::VectorXd residual = Eigen::VectorXd::Zero(3 * m);
      Eigen::MatrixXd tangent = Eigen::MatrixXd::Zero(3 * m, 3 * m);
      for (const Point& p : points_) {
        const double wx = p.wx.dot(z_.head(m)), wy = p.wy.dot(z_.head(m));
        Eigen::MatrixXd b = Eigen::MatrixXd::Zero(3, 3 * m);
        b.row(0) << wx * p.wx.transpose(), p.ux.transpose(), Eigen::RowVectorXd::Zero(m);
        b.row(1) << wy * p.wy.transpose(), Eigen::RowVectorXd::Zero(m), p.vy.transpose();
        b.row(2) << (wx * p.wy + wy * p.wx).transpose(), p.uy.transpose(), p.vx.transpose();
        Eigen::Vector3d strain = b * z_;  // counts the quadratic part twice
        strain -= Eigen::Vector3d(0.5 * wx * wx, 0.5 * wy * wy, wx * wy);
        const Eigen::Vector3d force = c * elastic * strain;
        const Eigen::Matrix3Xd k = p.curvature;
        const Eigen::Vector3d moment = d * elastic * (k * z_.head(m));
        residual += p.weight * b.transpose() * force;
        residual.head(m) += p.weight * (k.transpose() * moment - q * p.w);
        tangent += p.weight * c * b.transpose() * elastic * b;
        tangent.topLeftCorner(m, m) +=
            p.weight *
            (d * k.transpose() * elastic * k + force(0) * p.wx * p.wx.transpose() + force(1) * p.wy * p.wy.transpose() +
             force(2) * (p.wx * p.wy.transpose() + p.wy * p.wx.transpose()));
      }
      const Eigen::VectorXd step = tangent.ldlt().solve(residual);
      z_ -= step;
      if (step.lpNorm<Eigen::Infinity>() < 1e-12) break;
    }
    double centre = 0;
    for (int i = 0; i < n_; ++i)
      for (int j = 0; j < n_; ++j) centre += z_(i * n_ + j) * clamped(i, 0)[0] * clamped(j, 0)[0];
    return centre;
  }

 private:
  using Jet = std::array<double, 3>;  ///< value, first and second derivative
  struct Point {
    double weight;
    Eigen::VectorXd w, wx, wy, ux, uy, vx, vy;
    Eigen::Matrix3Xd curvature;  ///< w_xx, w_yy, 2 w_xy
  };

  static Jet multiply(const Jet& a, const Jet& b) {
    return {a[0] * b[0], a[1] * b[0] + a[0] * b[1], a[2] * b[0] + 2 * a[1] * b[1] + a[0] * b[2]};
  }
  static Jet legendre(int degree, double x) {
    Jet last{1, 0, 0}, now{x, 1, 0};
    if (degree == 0) return last;
    for (int k = 1; k < degree; ++k) {
      const Jet product = multiply({x, 1, 0}, now);
      Jet next;
      for (int i = 0; i < 3; ++i) next[i] = ((2 * k + 1) * product[i] - k * last[i]) / (k + 1);
      last = now;
      now = next;
    }
    return now;
  }
  static Jet clamped(int i, double x) {
    const Jet bubble{1 - x * x, -2 * x, -2};
    return multiply(multiply(bubble, bubble), legendre(2 * i, x));
  }
  static Jet normal(int i, double x) { return multiply({x - x * x * x, 1 - 3 * x * x, -6 * x}, legendre(2 * i, x)); }
  static Jet along(int i, double x) { return legendre(2 * i, x); }

  /// Point and weight i of Gauss' rule, by Newton on the Legendre polynomial.
  static std::pair<double, double> gauss(int n, int i) {
    double x = std::cos(M_PI * (i + 0.75) / (n + 0.5));
    for (int k = 0; k < 50; ++k) x -= legendre(n, x)[0] / legendre(n, x)[1];
    return {x, 2 / ((1 - x * x) * std::pow(legendre(n, x)[1], 2))};
  }

  void add_point(const std::pair<double, double>& x, const std::pair<double, double>& y) {
    Point p;
    p.weight = x.second * y.second;
    for (Eigen::VectorXd* v : {&p.w, &p.wx, &p.wy, &p.ux, &p.uy, &p.vx, &p.vy}) v->resize(n_ * n_);
    p.curvature.resize(3, n_ * n_);
    for (int i = 0; i < n_; ++i) {
      for (int j = 0; j < n_; ++j) {
        const int k = i * n_ + j;
        const Jet a = clamped(i, x.first), b = clamped(j, y.first);
        p.w(k) = a[0] * b[0];
        p.wx(k) = a[1] * b[0];
        p.wy(k) = a[0] * b[1];
        p.curvature.col(k) << a[2] * b[0], a[0] * b[2], 2 * a[1] * b[1];
        const Jet u = normal(i, x.first), u_along = along(j, y.first);
        p.ux(k) = u[1] * u_along[0];
        p.uy(k) = u[0] * u_along[1];
        const Jet v = normal(j, y.first), v_along = along(i, x.first);
        p.vx(k) = v_along[1] * v[0];
        p.vy(k) = v_along[0] * v[1];
      }
    }
    points_.push_back(std::move(p));
  }

  double poisson_;
  int n_;
  std::vector<Point> points_;
  Eigen::VectorXd z_;
};

}  // namespace interply::test
