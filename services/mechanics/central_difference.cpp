#include "mechanics/central_difference.hpp"

namespace interply::mechanics {

NodalMotion make_motion_at_rest(const TriangleMesh& mesh) {
  return {.kick_nodes = simd::choose([](auto target) { return &kick_nodes<decltype(target)>; }),
          .velocity = NodalVectors::Zero(3, mesh.n_nodes())};
}

void drift(NodalMotion& motion, double dt, NodalVectors& position) {
  position += dt * motion.velocity;
  motion.dt = dt;
}

void kick(NodalMotion& motion, double next_dt, const NodalVectors& contact_force, NodalVectors& internal_force,
          const Scalars& mass, const std::vector<int>& symmetry_nodes) {
  for (const int i : symmetry_nodes) internal_force(1, i) = contact_force(1, i);
  const auto &f = contact_force, &g = internal_force;
  auto& v = motion.velocity;
  const KickRows rows{
      mass.data(), {&f(0, 0), &f(1, 0), &f(2, 0)}, {&g(0, 0), &g(1, 0), &g(2, 0)}, {&v(0, 0), &v(1, 0), &v(2, 0)}};
  const KickSums sums = motion.kick_nodes(rows, 0.5 * (motion.dt + next_dt), mass.size());
  motion.kinetic = sums.kinetic;
  motion.work.contact += motion.ahead.contact + 0.5 * motion.dt * sums.before.contact;
  motion.work.internal += motion.ahead.internal + 0.5 * motion.dt * sums.before.internal;
  motion.ahead = {0.5 * next_dt * sums.after.contact, 0.5 * next_dt * sums.after.internal};
}

}  // namespace interply::mechanics
