/// Hosts what lies between the layers: contact, friction, tools, blank holder, time and supervision.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "exchange/link.hpp"
#include "observe/frames.hpp"
#include "scene/scene.hpp"

namespace interply::coordinator {

/// What a person watching the run wants to know; reported about twice a second.
struct Progress {
  std::int64_t step = 0;
  double time = 0, end_time = 0, dt = 0;  ///< s
  double stroke = 0;                      ///< mm
  double punch_force = 0;                 ///< N, modelled part
  double residual = 0;                    ///< energy residual / energy scale
  double seconds_left = -1;               ///< wall time, < 0 unknown
  std::string waiting_for;                ///< "ply_2" while waiting for long; empty otherwise
};

/// What a finished run measured of itself; the same numbers as in its summary.
struct Measures {
  std::int64_t steps = 0;
  double largest_residual = 0;  ///< energy residual / energy scale, over all steps
  double final_residual = 0;    ///< the same at the end
  double penetration_99 = 0;  ///< 99 % of the contact area stays below, worst frame; / thickness of the thinner partner
  double penetration_peak = 0;  ///< over all frames; / thickness of the thinner partner
  double holder_deviation = 0;  ///< largest |blank-holder force - target| after the ramp, / target
  double holder_mean = 0;       ///< blank-holder force, mean after the ramp, N
};

/// How the run ended.
struct Outcome {
  int exit_code = 0;         ///< 0 done, 1 the record cannot be written, 3 diverged, 4 lost, 5 cancelled
  std::string message;       ///< one sentence if not done
  std::string digest;        ///< 16 hex digits of the final state of all layers, also if only the record was lost then
  std::string summary;       ///< one screen of text, without the digest line; as above
  std::string summary_json;  ///< the same numbers with their units (proto/summary.proto); as above
  Measures measures;         ///< of a run that is done
  int frames_recorded = -1;  ///< as its recorder has said; -1: the link has none
};

/// Runs a scene over a link from waiting for the participants to the end. Never throws for what happens in a run.
/// Where the link has a recorder, no frame is ordered that it cannot keep up with, and done means that the record is.
/// `report` is called on progress, `log` with one plain line at a time ("waiting for ply_2 at step 1234 for 5 s").
Outcome run(const scene::Scene& scene, const std::string& run_name, exchange::CoordinatorLink& link,
            observe::Sink& sink, const std::function<void(const Progress&)>& report,
            const std::function<void(const std::string&)>& log);

/// One line for a terminal: stroke, step, dt, time left, energy residual, who is waited for.
std::string format_progress(const Progress& progress);

/// Names of the interfaces in order, "lower|upper", tools included, the layer whose nodes carry each one's tractions,
/// and who is on the other side.
struct InterfaceName {
  std::string name, nodes_of, other;
};
std::vector<InterfaceName> name_interfaces(const scene::Scene& scene);

}  // namespace interply::coordinator
