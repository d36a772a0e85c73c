/// Elements of a ply, compiled for each target of simd/target.hpp: loops over the formulas of woven_law.hpp,
/// membrane.hpp, stable_increment.hpp and mechanics/shell_kernels.hpp.
#pragma once

#include <cstddef>

#include "mechanics/shell_rows.hpp"
#include "simd/target.hpp"
#include "solver_fabric/membrane_law.hpp"

namespace interply::fabric {

/// Beyond these an element counts as folded (solver_fabric/THEORY.md: gamma -> 90 deg is an error, not a NaN).
inline constexpr double kFoldedCosine = 0.08715574274765817;  ///< cos 85 deg
inline constexpr double kFoldedAreaRatio = 0.02;              ///< current / reference area

/// What a pass over a range of elements gives.
struct MembraneResult {
  double energy = 0;           ///< mJ
  std::ptrdiff_t failed = -1;  ///< first element that is folded or has no finite energy, or -1
};

struct BendingStiffness {
  double warp = 0, weft = 0, twist = 0;  ///< N mm
};

struct FabricKernels {
  /// First pass: facets, and A t S_ab into the membrane rows. @param x  rows of the nodal positions
  MembraneResult (*stretch)(const mechanics::ShellRows& shell, const double* const x[3], const MembraneLaw& law,
                            double thickness, std::ptrdiff_t begin, std::ptrdiff_t end);
  /// Second pass: moments m11 = D_a kappa11, m22 = D_b kappa22, m12 = twist 2 kappa12. Returns their energy, mJ.
  double (*bend)(const mechanics::ShellRows& shell, const double* phi, const BendingStiffness& stiffness,
                 std::ptrdiff_t begin, std::ptrdiff_t end);
  /// Largest of the bounds (T1) of stable_increment.hpp, MPa/mm2.
  double (*bound)(const mechanics::ShellRows& shell, const double* const x[3], const MembraneLaw& law,
                  std::ptrdiff_t begin, std::ptrdiff_t end);
};

template <class Target>
const FabricKernels& get_fabric_kernels();
template <>
const FabricKernels& get_fabric_kernels<simd::Scalar>();
template <>
const FabricKernels& get_fabric_kernels<simd::Avx2>();
template <>
const FabricKernels& get_fabric_kernels<simd::Avx512>();

inline const FabricKernels& choose_fabric_kernels() {
  return simd::choose([](auto t) -> auto& { return get_fabric_kernels<decltype(t)>(); });
}

}  // namespace interply::fabric
