/// Central difference in time with lumped mass (services/mechanics/THEORY.md), and the energy terms that belong to it.
#pragma once

#include "mechanics/kick_nodes.hpp"
#include "mechanics/mesh.hpp"

namespace interply::mechanics {

/// Work of the two forces on the nodes, mJ.
struct NodalWork {
  double contact = 0;   ///< done by the contact force
  double internal = 0;  ///< done against the internal force
};

/// How the nodes of a layer move; their position is the caller's, who sends it.
struct NodalMotion {
  KickNodes* kick_nodes;  ///< compiled for this machine
  NodalVectors velocity;  ///< v(n - 1/2), after the kick v(n + 1/2)  [3 x n_nodes] mm/s
  double dt = 0;          ///< t(n) - t(n - 1), s; 0 at the start
  // filled by kick()
  double kinetic = 0;  ///< 1/2 m v(n - 1/2) . v(n + 1/2), mJ
  NodalWork work;      ///< up to x(n)
  NodalWork ahead;     ///< of the forces at n over the coming half increment, 1/2 f(n) . (x(n + 1) - x(n))
};

/// At rest.
NodalMotion make_motion_at_rest(const TriangleMesh& mesh);

/// x(n) -> x(n + 1) = x(n) + dt v(n + 1/2). @param dt  the `next_dt` of the kick before
void drift(NodalMotion& motion, double dt, NodalVectors& position);

/// v(n - 1/2) -> v(n + 1/2) = v + (dt_n + dt_n+1)/2 (f_contact - f_int)/m; symmetry nodes, where v_y = 0, keep it: the
/// reaction of their plane is added to f_int.
/// The work of a step is the trapezoid 1/2 (f(n - 1) + f(n)) . (x(n) - x(n - 1)), each half taken when its force is
/// there; at constant dt it balances the kinetic energy to round-off.
void kick(NodalMotion& motion, double next_dt, const NodalVectors& contact_force, NodalVectors& internal_force,
          const Scalars& mass, const std::vector<int>& symmetry_nodes);

}  // namespace interply::mechanics
