/// What is said of a scene's tools before anything runs: where they stand, what they are too fine for, and whether they
/// pass each other.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include "coordinator/tools.hpp"

namespace interply::coordinator {

/// A tool as it stands before forming.
struct ToolFacts {
  std::string name;     ///< die, blank_holder, punch
  std::string shape;    ///< in words
  double size[3] = {};  ///< mm along x, y, z: of an analytic plate that of its opening with the shoulder, which it has
                        ///< no outline beside
  double touching = 0;  ///< height of the place that touches the flat stack, mm
  double moved = 0;     ///< upwards, from the coordinates of the file, mm
  double radius = std::numeric_limits<double>::infinity();  ///< smallest convex one that the blank can come to, mm;
                                                            ///< infinite: none (of a surface: estimated)
};

struct ToolCheck {
  std::vector<ToolFacts> tools;
  double flange_area = 0;             ///< under the blank holder, of the modelled part, mm2
  double blank_area = 0;              ///< of the modelled part of the uppermost layer, mm2
  std::vector<std::string> warnings;  ///< one sentence each
};

/// What analytic tools are checked for when the scene is read, for tools given as STL: the blank is in front of them,
/// the punch at full stroke leaves the thickness of the stack to the die and does not meet the blank holder. Surfaces
/// are sampled every 2 mm.
///
/// Warns of a tool that the half model cuts in two unequal halves, of holes in a surface, of a tool that meets no node,
/// and of a radius below three quarters of the element size: contact acts at nodes. The radius of a surface is
/// estimated at its vertices within reach of the blank, at the scale of the elements, from how far it falls beside the
/// tangent plane by the signed distance: needles and the noise of single precision do not count.
/// @throws scene::SceneError  as place_tools(), and where a check fails
ToolCheck check_tools(const scene::Scene& scene);

}  // namespace interply::coordinator
