/// The passes of a shell that no material law enters (edge_shell.hpp, edge_motion.hpp), compiled for each target of
/// simd/target.hpp. All work on a range [begin, end) of their points; ranges may run on any thread in any order.
#pragma once

#include <cstddef>

#include "mechanics/shell_rows.hpp"
#include "simd/target.hpp"

namespace interply::mechanics {

/// Rows over the edges (EdgeMotion).
struct EdgeRows {
  const double *inertia, *mobility, *decay;  ///< J, 1/J or 0, damping torque/(J phi')
  double *angle, *rate, *torque, *friction;  ///< phi, phi', -dW/dphi, damping torque
};

/// Energies of a range of edges, mJ.
struct EdgeEnergies {
  double kinetic = 0;   ///< 1/2 J phi'(n - 1/2) phi'(n + 1/2), the same dt before and after
  double friction = 0;  ///< work of the damping in this step
};

struct ShellPassKernels {
  /// Mirror images [begin, end) of facets, behind the ring in t3.
  void (*reflect_facets)(const ShellRows& shell, std::ptrdiff_t begin, std::ptrdiff_t end);
  /// Third pass: corner_force of the elements (B5, B6).
  void (*compute_corner_forces)(const ShellRows& shell, std::ptrdiff_t begin, std::ptrdiff_t end);
  /// Kick with the last torques over `span`, drift over `dt`.
  void (*advance_edges)(const EdgeRows& edges, double span, double dt, std::ptrdiff_t begin, std::ptrdiff_t end);
  /// Torques from the second pass of the elements of the edges.
  EdgeEnergies (*update_torques)(const ShellRows& shell, const EdgeRows& edges, double dt, std::ptrdiff_t begin,
                                 std::ptrdiff_t end);
  /// Sum of the corner forces of each node in the order of the incidence (mesh.hpp). @param force  rows, N
  void (*gather_forces)(const ShellRows& shell, double* const force[3], std::ptrdiff_t begin, std::ptrdiff_t end);
};

template <class Target>
const ShellPassKernels& get_shell_pass_kernels();
template <>
const ShellPassKernels& get_shell_pass_kernels<simd::Scalar>();
template <>
const ShellPassKernels& get_shell_pass_kernels<simd::Avx2>();
template <>
const ShellPassKernels& get_shell_pass_kernels<simd::Avx512>();

inline const ShellPassKernels& choose_shell_pass_kernels() {
  return simd::choose([](auto t) -> auto& { return get_shell_pass_kernels<decltype(t)>(); });
}

}  // namespace interply::mechanics
