/// The passes of a sheet that its law enters, compiled for each target of simd/target.hpp: J2 and Hill48, elements
/// innermost.
#pragma once

#include <cstddef>

#include "mechanics/shell_rows.hpp"
#include "simd/target.hpp"
#include "solver_metal/law_constants.hpp"

namespace interply::metal {

/// Rows of the state of a sheet, each contiguous over the elements; those of point i of n_points as named.
struct SheetRows {
  double *metric[3], *curvature[3];    ///< C11, C22, C12 and kappa11, kappa22, kappa12 (1/mm)
  double* thickness;                   ///< mm
  double* stress;                      ///< row 3i + (s11, s22, s12), MPa
  double* plastic_strain;              ///< row i
  double *yield_stress, *yield_slope;  ///< row i, MPa
  const double *xi, *weight;           ///< ThicknessRule [n_points]
  int n_points = 0;                    ///< at most kMostPoints of lobatto.hpp
  std::ptrdiff_t n = 0;                ///< elements
};

/// What a range of elements hands back.
struct SheetAdvance {
  double work = 0;          ///< stress work, mJ
  std::ptrdiff_t bad = -1;  ///< first element whose thickness is not positive and finite, or -1
};

/// No principal plane stress exceeds 2/sqrt(3) of the equivalent stress of von Mises.
inline constexpr double kPrincipalPerVonMises = 1.1547005383792517;

/// What the bound of the stable increment needs beside the state (stable_increment.hpp).
struct IncrementRows {
  const double* nodal_stiffness;          ///< q_k/m_k of (T2), over the nodes, mm/t
  const double* bending_frequency2;       ///< of the flat sheet of thickness0, over the elements, 1/s2
  double young = 0, poisson = 0;          ///< of the tangent; E, MPa; nu
  double stiffening = 1, thickness0 = 0;  ///< of the tangent against that of the flat sheet; mm
};

struct MetalKernels {
  /// First pass for the elements [begin, end): facets at the nodal positions x.
  /// @return the first of them whose area ratio is not in (smallest, largest], or -1
  std::ptrdiff_t (*compute_facets)(const mechanics::ShellRows& shell, const double* const x[3], double smallest,
                                   double largest, std::ptrdiff_t begin, std::ptrdiff_t end);
  /// Second pass: curvature, strain, stress, thickness, and moments and membrane forces into the passes of the shell.
  /// @param phi  rotation of each edge
  SheetAdvance (*advance)(const mechanics::ShellRows& shell, const SheetRows& sheet, const LawConstants& law,
                          const double* phi, std::ptrdiff_t begin, std::ptrdiff_t end);
  /// Adds v |g_k|^2 of all elements to q of (T2), over the nodes.
  void (*add_nodal_stiffness)(const mechanics::ShellRows& shell, const SheetRows& sheet, double* q);
  /// Bound of the highest w^2 of the elements [begin, end) (T1), 1/s2.
  double (*bound_frequency2)(const mechanics::ShellRows& shell, const SheetRows& sheet, const IncrementRows& rows,
                             std::ptrdiff_t begin, std::ptrdiff_t end);
};

/// Defined for the tags of simd/target.hpp.
template <class Target>
const MetalKernels& get_metal_kernels();

}  // namespace interply::metal
