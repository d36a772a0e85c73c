#include "mechanics/central_difference.hpp"

#include <numeric>

namespace interply::mechanics {

NodalMotion make_motion_at_rest(const TriangleMesh& mesh) {
  const NodalVectors zero = NodalVectors::Zero(3, mesh.n_nodes());
  return {.position = mesh.reference, .velocity = zero, .increment = zero};
}

void drift(NodalMotion& motion, double dt) {
  motion.increment = dt * motion.velocity;
  motion.position += motion.increment;
  motion.dt = dt;
}

double kick(NodalMotion& motion, double next_dt, const NodalVectors& contact_force, const NodalVectors& internal_force,
            const Scalars& mass, const std::vector<int>& symmetry_nodes) {
  const double span = 0.5 * (motion.dt + next_dt);
  const Eigen::Index n = mass.size();
  constexpr Eigen::Index kSums = 8;  // side by side, so that the loop vectorises
  double twice_kinetic[kSums] = {};
  for (int d = 0; d < 3; ++d) {
    double* v = &motion.velocity(d, 0);
    const double *contact = &contact_force(d, 0), *internal = &internal_force(d, 0), *m = mass.data();
    const auto advance = [&](Eigen::Index i, double& sum) {
      const double old = v[i];
      v[i] += span * (contact[i] - internal[i]) / m[i];
      sum += m[i] * old * v[i];
    };
    Eigen::Index i = 0;
    for (; i + kSums <= n; i += kSums)
      for (Eigen::Index l = 0; l < kSums; ++l) advance(i + l, twice_kinetic[l]);
    for (; i < n; ++i) advance(i, twice_kinetic[0]);
    if (d == 1)
      for (const int k : symmetry_nodes) v[k] = 0;  // it was 0 before as well: no energy enters
  }
  return 0.5 * std::accumulate(twice_kinetic, twice_kinetic + kSums, 0.0);
}

double compute_trapezoid_work(const NodalVectors& old_force, const NodalVectors& force, const NodalVectors& increment) {
  return 0.5 * ((old_force + force) * increment).sum();
}

}  // namespace interply::mechanics
