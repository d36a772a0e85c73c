/// Largest stable increment of layers that contact couples into a chain.
#pragma once

#include <vector>

#include "contact/points.hpp"

namespace interply::coordinator {

/// Bounds of the blocks of M^-1 K and M^-1 C of the members of a chain, bottom to top: the largest row sums of absolute
/// values.
struct Chain {
  explicit Chain(std::size_t n) : own(n), up(n - 1), down(n - 1) {}
  std::vector<contact::RowSum> own;   ///< of member i with itself
  std::vector<contact::RowSum> up;    ///< of member i with i + 1
  std::vector<contact::RowSum> down;  ///< of member i + 1 with i
};

struct FastestMode {
  double increment = 0;  ///< largest stable, s; infinite where nothing is stiff
  int member = 0;        ///< that moves most in the fastest mode, in kinetic energy
};

/// Central differences whose damping acts on the velocity half a step ago,
///
///   x(n+1) - 2 x(n) + x(n-1) + dt M^-1 C (x(n) - x(n-1)) + dt^2 M^-1 K x(n) = 0:
///
/// a mode z^n x, multiplied by x* M, is a quadratic equation for z with the real coefficients dt c and dt^2 k, and |z|
/// <= 1 as long as
///
///   dt^2 k + 2 dt c <= 4.                                                                                     (D1)
///
/// The left side is at most the largest eigenvalue of M^-1/2 (dt^2 K + 2 dt C) M^-1/2, and this at most that of the
/// small matrix of the norms of its blocks. The square of the norm of block ij of M^-1/2 K M^-1/2 is the largest
/// eigenvalue of M_i^-1 K_ij M_j^-1 K_ji, so at most up_i down_i for j = i + 1. For one oscillator with damping zeta
/// (D1) is dt <= (2/omega)(sqrt(1 + zeta^2) - zeta); the fastest mode of a stack has a larger fraction of critical
/// damping than a pair.
FastestMode find_fastest_mode(const Chain& chain);

}  // namespace interply::coordinator
