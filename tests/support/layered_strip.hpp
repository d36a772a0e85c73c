/// Elastic-plastic pure bending of a sheet in plane strain by fibres through its thickness: independent of the solver.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>
#include <vector>

namespace interply::test {

/// Heights xi in [-1, 1] over the half thickness and weights that sum to 1.
struct Fibres {
  std::vector<double> xi, weight;
};

/// Midpoints of n equal intervals: the exact integral, error of order 1/n^2.
inline Fibres make_midpoint_fibres(int n) {
  Fibres fibres;
  for (int i = 0; i < n; ++i) {
    fibres.xi.push_back(-1 + (2 * i + 1.0) / n);
    fibres.weight.push_back(1.0 / n);
  }
  return fibres;
}

/// Gauss-Lobatto points, the roots of (1 - x^2) P'_{n-1}, by Newton's method; weights 2/(n (n - 1) P_{n-1}^2), halved.
inline Fibres make_lobatto_fibres(int n) {
  Fibres fibres;
  for (int i = 0; i < n; ++i) {
    double x = -std::cos(std::numbers::pi * i / (n - 1)), p = 1;
    for (int k = 0; k < 100; ++k) {
      double last = 1;
      p = x;
      for (int m = 1; m < n - 1; ++m) last = std::exchange(p, ((2 * m + 1) * x * p - m * last) / (m + 1));
      x -= (x * p - last) / (n * p);  // of (1 - x^2) P' = (n - 1)(P_{n-2} - x P), slope -n (n - 1) P
    }
    fibres.xi.push_back(x);
    fibres.weight.push_back(1 / (n * (n - 1) * p * p));
  }
  return fibres;
}

/// J2 in three dimensions, isotropic hardening, small strain. Plane strain across the strip, no stress through its
/// thickness; a fibre at z has the strain z kappa. Radial return (Wilkins), the thickness strain by the secant method.
class LayeredStrip {
 public:
  /// @param flow  flow stress over the equivalent plastic strain, MPa
  LayeredStrip(double young, double poisson, double thickness, const Fibres& fibres, std::function<double(double)> flow)
      : shear_(young / (2 * (1 + poisson))),
        bulk_(young / (3 * (1 - 2 * poisson))),
        thickness_(thickness),
        flow_(std::move(flow)),
        rule_(fibres),
        fibres_(fibres.xi.size()) {}

  /// Bends in 100 steps from the curvature of the last call to `kappa` (1/mm); the moment per width, N.
  double bend(double kappa) {
    const int steps = 100;
    const double from = kappa_;
    for (int s = 1; s <= steps; ++s) advance(from + (kappa - from) * s / steps);
    double sum = 0;
    for (std::size_t i = 0; i < fibres_.size(); ++i)
      sum += rule_.weight[i] * thickness_ * height(i) * fibres_[i].stress(0);
    return sum;
  }

 private:
  struct Fibre {
    Eigen::Array3d stress = Eigen::Array3d::Zero();  ///< along, across, through the thickness, MPa
    double plastic = 0;                              ///< equivalent strain
    double ratio = -0.4;                             ///< thickness strain over strain along, of the last step
  };

  double height(std::size_t i) const { return 0.5 * thickness_ * rule_.xi[i]; }

  void advance(double kappa) {
    for (std::size_t i = 0; i < fibres_.size(); ++i) {
      const double along = height(i) * (kappa - kappa_);
      Fibre& fibre = fibres_[i];
      Fibre next = fibre;
      double a = fibre.ratio, b = a + 0.01, fa = return_stress(fibre, along, a * along).stress(2);
      for (int k = 0; k < 60; ++k) {
        next = return_stress(fibre, along, b * along);
        const double fb = next.stress(2);
        if (std::abs(fb) < 1e-6 || fb == fa) break;
        const double c = b - fb * (b - a) / (fb - fa);
        a = std::exchange(b, c);
        fa = fb;
      }
      next.ratio = b;
      fibre = next;
    }
    kappa_ = kappa;
  }

  Fibre return_stress(const Fibre& old, double along, double through) const {
    const Eigen::Array3d strain(along, 0, through);
    const double mean = old.stress.mean() + bulk_ * strain.sum();
    const Eigen::Array3d trial = old.stress - old.stress.mean() + 2 * shear_ * (strain - strain.mean());
    const double equivalent = std::sqrt(1.5 * trial.square().sum());
    double dp = 0;
    if (equivalent > flow_(old.plastic)) {  // equivalent - 3 G dp = flow(p + dp), falling in dp: bisection
      double low = 0, high = equivalent / (3 * shear_);
      for (int k = 0; k < 36; ++k) {
        dp = 0.5 * (low + high);
        (equivalent - 3 * shear_ * dp > flow_(old.plastic + dp) ? low : high) = dp;
      }
    }
    Fibre now = old;
    now.plastic += dp;
    now.stress = trial * (1 - 3 * shear_ * dp / std::max(equivalent, 1e-300)) + mean;
    return now;
  }

  double shear_, bulk_, thickness_, kappa_ = 0;
  std::function<double(double)> flow_;
  Fibres rule_;
  std::vector<Fibre> fibres_;
};

}  // namespace interply::test
