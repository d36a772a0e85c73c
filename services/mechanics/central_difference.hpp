/// Central difference in time with lumped mass (services/mechanics/THEORY.md), and the energy terms that belong to it.
#pragma once

#include "mechanics/mesh.hpp"

namespace interply::mechanics {

/// What moves: nodes, velocities at the half step, and the increment that led to the current positions.
struct NodalMotion {
  NodalVectors position;   ///< x(n)                      [3 x n_nodes] mm
  NodalVectors velocity;   ///< v(n - 1/2), after the kick v(n + 1/2)  [3 x n_nodes] mm/s
  NodalVectors increment;  ///< x(n) - x(n - 1)           [3 x n_nodes] mm
  double dt = 0;           ///< t(n) - t(n - 1), s; 0 at the start
};

/// At rest in the reference position.
NodalMotion make_motion_at_rest(const TriangleMesh& mesh);

/// x(n) -> x(n + 1) = x(n) + dt v(n + 1/2).
void drift(NodalMotion& motion, double dt);

/// v(n - 1/2) -> v(n + 1/2) = v + (dt_n + dt_n+1)/2 (f_contact - f_int)/m; symmetry nodes keep v_y = 0.
/// Returns the kinetic energy 1/2 m v(n - 1/2) . v(n + 1/2), for which, at constant dt, the trapezoid work of the
/// forces over the displacement increments is exact to round-off; mJ.
double kick(NodalMotion& motion, double next_dt, const NodalVectors& contact_force, const NodalVectors& internal_force,
            const Scalars& mass, const std::vector<int>& symmetry_nodes);

/// 1/2 (f(n - 1) + f(n)) . (x(n) - x(n - 1)), mJ.
double compute_trapezoid_work(const NodalVectors& old_force, const NodalVectors& force, const NodalVectors& increment);

}  // namespace interply::mechanics
