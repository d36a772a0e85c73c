/// What no layer of a scene can send: it is named at the edge, before it reaches its neighbours through contact.
#pragma once

#include <string>

#include "exchange/link.hpp"
#include "mechanics/mesh.hpp"
#include "scene/scene.hpp"

namespace interply::coordinator {

class Plausibility {
 public:
  /// @param mesh  of layer `layer`
  Plausibility(const scene::Scene& scene, int layer, const mechanics::TriangleMesh& mesh);

  /// A sentence about the first thing that cannot be: a position, thickness or energy that is no finite number or is
  /// absurd, an increment with which the run would not end. Empty: nothing. One pass over the positions.
  std::string find_fault(const exchange::Motion& motion) const;

 private:
  std::string name_;
  double farthest_;   ///< from the origin, that a node may be, mm
  double thickness_;  ///< mm
  double end_time_;   ///< s
};

}  // namespace interply::coordinator
