/// Raw rows of a shell for its kernels.
#pragma once

#include <cstddef>

namespace interply::mechanics {

struct ShellGeometry;
struct ShellPasses;

/// Rows of ShellGeometry, each contiguous over the elements, and of the rings of ShellPasses (edge_shell.hpp). Valid
/// while both live.
struct ShellRows {
  /// Ring of edge_shell.hpp. The own elements of a kernel, [begin, end), lie in the columns [begin + shift, end +
  /// shift).
  struct View {
    std::ptrdiff_t size, stride, shift;
  };

  ShellRows(const ShellGeometry& shell, ShellPasses& passes);

  /// Before kernels work on elements from `begin` on; no ring may end among them.
  void turn_to(std::ptrdiff_t begin);

  // constant
  const int *node[3], *edge[3];
  const double *gradient[6], *area;
  const signed char *side[3], *hinged[3];
  const int *image_facet, *first_side, *second_side, *gather_start, *gather_entry;
  const double* image_plane[2];
  const int *across[3], *opposite[3];

  View facets, moments, corners;
  double *f1[3], *f2[3], *t3[3], *area_ratio, *membrane[3];  ///< facets
  double *slope_moment, *hinge_factor, *height_force;        ///< moments: rows of sides
  double* corner_force[3];                                   ///< corners: rows of sides
};

}  // namespace interply::mechanics
