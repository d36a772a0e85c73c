/// What the coordinator publishes: header, interface and tool frames.
#pragma once

#include <string>

#include "coordinator/energy_balance.hpp"
#include "coordinator/pace.hpp"
#include "coordinator/stack.hpp"
#include "observe/frames.hpp"

namespace interply::coordinator {

observe::RunHeader make_header(const scene::Scene& scene, const std::string& run_name, const Stack& stack);

/// One InterfaceFrame per interface and one ToolFrame per tool of the current step.
void put_frames(const scene::Scene& scene, const Stack& stack, const Pace& pace, observe::Sink& sink);

/// The participant or interface that the balance explains worst, and what usually helps.
struct Share {
  std::string name;
  double value = 0;  ///< mJ
  std::string cure;
};
Share explain_residual(const scene::Scene& scene, const EnergyBalance& balance);

}  // namespace interply::coordinator
