/// Tools as triangles, for pictures: those given as STL as they are, parametric ones sampled.
#pragma once

#include <vector>

#include "coordinator/tools.hpp"
#include "observe/frames.hpp"

namespace interply::coordinator {

/// Surfaces of die, blank holder and punch (if there is one), each relative to its reference point. Nodes of parametric
/// tools lie on the surface, on the punch three degrees apart as seen from the middle of its base; lands reach beyond
/// the blank, walls as far as the stroke.
std::vector<observe::ToolSurface> make_tool_surfaces(const scene::Scene& scene, const PlacedTools& placed,
                                                     const mechanics::TriangleMesh& blank);

}  // namespace interply::coordinator
