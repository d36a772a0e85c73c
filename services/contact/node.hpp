/// What contact reads of a node of a layer.
#pragma once

#include "contact/quad.hpp"

namespace interply::contact {

/// A node at one instant. In one place, not in rows, for contact reads nodes by their numbers.
struct alignas(64) Node {
  Quad position;   ///< x(n), mm; in `w` half the current thickness, mm
  Quad normal;     ///< averaged unit vertex normal, up
  Quad increment;  ///< x(n) - x(n - 1), mm
  Quad turn;       ///< of the normal, n(n) - n(n - 1)
};

}  // namespace interply::contact
