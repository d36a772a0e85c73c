/// Motion of the edge rotations phi of a shell (edge_shell.hpp) by central difference, and the bound of its bending
/// frequencies.
///
/// The inertia is a device of the integrator. phi is a rotation relative to the facets, so rigid motion moves no edge
/// and linear and angular momentum know nothing of it:
///
///   J = sum over the elements of the edge of m h_k^2     (m mass with scaling, h_k reference height)       (B7)
///
/// In bending waves of wave number k an edge turns by less than kappa h/4, so it holds less than about (k h)^4/16 of
/// the kinetic energy: waves longer than some ten elements do not feel it (services/mechanics/THEORY.md 2).
/// Each edge is damped at the fraction kEdgeDamping of its own critical rate 2 sqrt(K/J), K its bending stiffness with
/// the nodes held. It is far above the frequencies of the sheet, which loses a fraction of about their ratio of that.
#pragma once

#include "mechanics/edge_shell.hpp"
#include "mechanics/shell_passes.hpp"

namespace interply::mechanics {

/// Of critical. Ringing dies out within some ten periods of the edge.
inline constexpr double kEdgeDamping = 0.1;

/// Plate of one material: moment per curvature (k11, k22, 2 k12), N mm, and mass per area (with scaling), t/mm2.
struct Plate {
  Eigen::Matrix3d stiffness;
  double areal_density = 0;
};

/// Rotations of all edges and what drives them; arrays [n_edges].
class EdgeMotion {
 public:
  EdgeMotion(const ShellGeometry& shell, const Plate& plate);

  const Scalars& angle() const { return angle_; }      ///< phi
  const Scalars& rate() const { return rate_; }        ///< phi' at the half step, 1/s
  const Scalars& inertia() const { return inertia_; }  ///< J of (B7), t mm2

  /// phi(n - 1) -> phi(n): kick with the last torques over (dt_old + dt)/2, drift over `dt`, for the edges [begin,
  /// end). dt = 0: nothing moves.
  void advance(double dt, Eigen::Index begin, Eigen::Index end);
  /// Torques at n from the second pass of n, for the edges [begin, end).
  EdgeEnergies update_torques(const ShellRows& shell, double dt, Eigen::Index begin, Eigen::Index end);
  /// Once all edges are through: the energy that left the shell towards them since the last torques, to be booked with
  /// its internal energy, mJ: the change of their kinetic energy, which balances to round-off at constant dt, and the
  /// work of the damping.
  double finish(double dt, const EdgeEnergies& all);

 private:
  EdgeRows rows();

  Scalars inertia_;   ///< t mm2
  Scalars mobility_;  ///< 1/J, 0 where the edge is mirrored
  Scalars decay_;     ///< damping torque / (J phi'), 1/s
  Scalars angle_, rate_;
  Scalars torque_;      ///< -dW/dphi, N mm
  Scalars friction_;    ///< damping torque, N mm
  double kinetic_ = 0;  ///< mJ
  double last_dt_ = 0;
  const ShellPassKernels& kernels_;
};

/// Per element of the flat shell, lambda_max(D B M^-1 B') A: the largest squared frequency of its bending alone, 1/s2,
/// and so of the mesh the largest of these. B (3 x 9) turns normal displacements of its three nodes and the three
/// beyond its edges, and the rotations of its edges, into curvatures; a node or edge shares its mass or inertia among
/// the elements that it moves in proportion to |B_s|^2 A. B is the same at any homogeneous stretch, but for the
/// columns of the edges, which grow like h_k, at most by the larger principal stretch. [n_el]
/// @param stiffness  D over (k11, k22, 2 k12), N mm
/// @param mass       lumped, t [n_nodes]
/// @param inertia    J, t mm2 [n_edges]
Scalars compute_bending_frequencies2(const ShellGeometry& shell, const Eigen::Matrix3d& stiffness, const Scalars& mass,
                                     const Scalars& inertia);

}  // namespace interply::mechanics
