/// What every solver process is: join, then drift - send - internal forces - receive - kick until told to leave.
#pragma once

#include <memory>
#include <string>

#include "exchange/link.hpp"
#include "observe/frames.hpp"
#include "solve/layer_mechanics.hpp"

namespace interply::solve {

/// "fabric" or "metal", as solvers and layers say what they are (exchange::Join).
inline const char* to_word(scene::Kind kind) { return kind == scene::Kind::Fabric ? "fabric" : "metal"; }

/// Makes one layer's mechanics; solver_fabric and solver_metal each provide one.
using LayerFactory = std::unique_ptr<LayerMechanics> (*)(const scene::Scene& scene, int layer,
                                                         const mechanics::TriangleMesh& mesh);

/// Runs one layer over a joined link from the initial state to Final. A divergence is sent to the coordinator before it
/// is thrown on.
/// @throws mechanics::Divergence, exchange::Stopped, exchange::CoordinatorLost
void run_session(const scene::Scene& scene, int layer, LayerFactory make_layer, exchange::SolverLink& link,
                 observe::Sink& sink);

/// main() of a solver process: `--connect ADDRESS --layer NAME [--scene FILE]`. Exit codes as of `interply run`.
int solver_main(int argc, char** argv, scene::Kind kind, LayerFactory make_layer);

}  // namespace interply::solve
