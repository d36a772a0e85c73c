#include "coordinator/fastest_mode.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>

namespace interply::coordinator {

FastestMode find_fastest_mode(const Chain& chain) {
  const auto n = static_cast<Eigen::Index>(chain.own.size());
  Eigen::MatrixXd k = Eigen::MatrixXd::Zero(n, n), c = k;
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto at = static_cast<std::size_t>(i);
    k(i, i) = chain.own[at].stiffness;
    c(i, i) = chain.own[at].damping;
    if (i + 1 == n) break;
    k(i, i + 1) = k(i + 1, i) = std::sqrt(chain.up[at].stiffness * chain.down[at].stiffness);
    c(i, i + 1) = c(i + 1, i) = std::sqrt(chain.up[at].damping * chain.down[at].damping);
  }
  FastestMode mode;
  double per_increment = 0;                  // 2/dt
  for (int round = 0; round < 4; ++round) {  // (D1) for the mode at hand changes dt by the square of the mode's error
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(k + per_increment * c);
    const Eigen::VectorXd x = solver.eigenvectors().col(n - 1);
    const double stiffness = x.dot(k * x), half = 0.5 * x.dot(c * x);
    per_increment = half + std::sqrt(half * half + stiffness);
    x.cwiseAbs().maxCoeff(&mode.member);
  }
  mode.increment = 2 / per_increment;
  return mode;
}

}  // namespace interply::coordinator
