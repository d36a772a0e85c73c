/// What acts at the nodes of an interface, as it is recorded (proto/RECORD.md). Computed at frames, never in a step.
#pragma once

#include <vector>

#include "coordinator/stack.hpp"
#include "observe/frames.hpp"

namespace interply::coordinator {

/// Fields at the nodes of the layer that carries the interface.
std::vector<observe::Field> describe_interface(const scene::Scene& scene, const Stack& stack, int interface);

/// What acts on the nodes of the other layer; nothing against a tool.
std::vector<observe::Field> describe_other_side(const Stack& stack, int interface);

}  // namespace interply::coordinator
