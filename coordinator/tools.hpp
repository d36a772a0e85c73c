/// The rigid tools of a scene where they stand before forming: analytic ones and those that users bring as STL.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "contact/signed_distance.hpp"
#include "geometry/stl.hpp"
#include "mechanics/mesh.hpp"
#include "scene/scene.hpp"

namespace interply::coordinator {

/// A tool that touches the flat stack.
struct PlacedTool {
  std::unique_ptr<contact::SignedDistance> shape;  ///< null: the scene has no such tool
  std::unique_ptr<geometry::Surface> surface;      ///< null: analytic
  double z = 0;                                    ///< height of the tool's own z = 0, mm
};

struct PlacedTools {
  PlacedTool die, blank_holder, punch;
  double flange_area = 0;  ///< of the modelled part of the blank, on which the blank-holder pressure acts, mm2
};

using Rectangle = Eigen::AlignedBox2d;

/// The bounding rectangle of the whole blank, mm. @param half  the mesh is the half y >= 0
Rectangle bound_blank(const mechanics::TriangleMesh& blank, bool half);

/// Tools at their starting heights. The stack stands on z = 0; a tool given as STL keeps its x and y and is moved along
/// z until it touches: the lowest point (of the die: the highest) that lies over the blank's bounding rectangle comes
/// to the stack's face. The rectangle of a half model reaches as far to -y as to +y.
///
/// The flange area under an analytic blank holder is exact. Under one given as STL it is the part of the blank within
/// 1e-3 mm of it, measured to about 1e-4.
/// @param lowest, uppermost  meshes of these layers
/// @param height             of the stack, mm
/// @throws scene::SceneError  if a file has changed or is no usable surface, nothing of a tool is over the blank, or
/// the
///                            holder touches less than 1 % of the blank
PlacedTools place_tools(const scene::Scene& scene, const mechanics::TriangleMesh& lowest,
                        const mechanics::TriangleMesh& uppermost, double height);

}  // namespace interply::coordinator
