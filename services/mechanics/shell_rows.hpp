/// Raw rows of a shell for its kernels.
#pragma once

#include <cstddef>

namespace interply::mechanics {

struct ShellGeometry;
struct ShellPasses;

/// Rows of ShellGeometry and ShellPasses (edge_shell.hpp), each contiguous over the elements, a row of sides over
/// 3 n. Valid while both live.
struct ShellRows {
  ShellRows(const ShellGeometry& shell, ShellPasses& passes);

  std::ptrdiff_t n = 0;  ///< elements
  const int *node[3], *across[3], *opposite[3], *edge[3];
  const double *gradient[6], *area, *side[3], *hinged[3];
  double *f1[3], *f2[3], *t3[3], *area_ratio, *membrane[3];
  double *slope_moment, *hinge_factor, *height_force;  ///< rows of sides
};

}  // namespace interply::mechanics
