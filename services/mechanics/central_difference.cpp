#include "mechanics/central_difference.hpp"

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
  double twice_kinetic = 0;
  for (int d = 0; d < 3; ++d) {
    auto v = motion.velocity.row(d);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double old = v(i);
      v(i) += span * (contact_force(d, i) - internal_force(d, i)) / mass(i);
      twice_kinetic += mass(i) * old * v(i);
    }
    if (d == 1)
      for (const int i : symmetry_nodes) v(i) = 0;  // it was 0 before as well: no energy enters
  }
  return 0.5 * twice_kinetic;
}

double compute_trapezoid_work(const NodalVectors& old_force, const NodalVectors& force, const NodalVectors& increment) {
  return 0.5 * ((old_force + force) * increment).sum();
}

}  // namespace interply::mechanics
