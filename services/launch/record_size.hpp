/// How large the record of a scene becomes.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "coordinator/stack.hpp"
#include "scene/scene.hpp"
#include "solve/layer_mechanics.hpp"

namespace interply::launch {

/// Bytes of record.h5 and record.xdmf, from what each participant would put into a frame (record/layout.hpp). 0 without
/// frames.
/// @param layers  of the scene, one each, at rest   @param stack  that has the motion of every layer
std::uint64_t measure_record(const scene::Scene& scene,
                             const std::vector<std::unique_ptr<solve::LayerMechanics>>& layers,
                             const coordinator::Stack& stack);

}  // namespace interply::launch
