/// What anyone may watch of a run, as plain values. DDS topics (`proto/observe.idl`) and the record carry exactly these.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "mechanics/nodal.hpp"

namespace interply::observe {

/// One named field of a layer's elements or nodes, with its unit.
struct Field {
  std::string name;         ///< e.g. "shear_angle"
  std::string unit;         ///< e.g. "rad"
  std::string description;
  bool nodal = false;       ///< per node, else per element
  std::vector<double> values;  ///< [n_nodes or n_elements] x components, point innermost (all of component 0 first)
  int components = 1;
};

/// Sent once by each solver before its first frame.
struct LayerMesh {
  std::string layer;
  std::string kind;                 ///< "fabric" or "metal"
  double thickness = 0;             ///< mm
  mechanics::NodalVectors reference;  ///< mm
  mechanics::Triangles triangles;
};

struct LayerFrame {
  std::string layer;
  int frame = 0;          ///< 0 = initial state
  std::int64_t step = 0;
  double time = 0;        ///< s
  mechanics::NodalVectors position;  ///< mm
  std::vector<Field> fields;
};

/// Tractions at the facing nodes of the lower layer (the nodes of its mesh), on the upper layer.
struct InterfaceFrame {
  std::string interface;  ///< "lower|upper", e.g. "ply_1|ply_2", "die|sheet_lower"
  std::string nodes_of;   ///< layer whose nodes carry the fields
  int frame = 0;
  std::int64_t step = 0;
  double time = 0;
  std::vector<Field> fields;  ///< pressure, tangential_traction [3], gap, slip, state (0 open, 1 stick, 2 slide)
};

struct ToolFrame {
  std::string tool;
  int frame = 0;
  std::int64_t step = 0;
  double time = 0;
  double position = 0;   ///< z of the tool's reference point, mm
  double force[3] = {};  ///< contact force on the tool, full modelled part, N
};

/// One row of /history.
struct HistoryRow {
  std::int64_t step = 0;
  double time = 0, dt = 0;            ///< s
  double stroke = 0;                  ///< mm
  double kinetic = 0, internal = 0, contact = 0, friction = 0, damping = 0, thinning = 0, external = 0;  ///< mJ
  double residual = 0;                ///< energy residual / scale
  double punch_force = 0, blank_holder_force = 0, blank_holder_target = 0;  ///< N
  double peak_penetration = 0;        ///< / thinner layer's thickness
  double contact_vote = 0;            ///< s
  std::vector<double> layer_kinetic, layer_internal, layer_residual;  ///< per layer, mJ
  std::vector<double> votes;          ///< stable increment per layer, s
  std::vector<double> step_seconds;   ///< wall time per step of each layer's process, s (mean since the last row)
  std::vector<double> wait_seconds;   ///< of that, waiting for the coordinator, s
  double coordinator_step_seconds = 0, coordinator_wait_seconds = 0;
  std::vector<double> interface_residual;  ///< per interface, mJ
};

/// Sent once by the coordinator before anything else.
struct RunHeader {
  std::string run;               ///< unique name of this execution
  std::string scene_text, version, scene_digest;
  std::vector<std::string> layers, interfaces, tools;  ///< in order; every frame and history row refers to these
  std::vector<std::string> interface_nodes_of;         ///< layer whose nodes carry each interface's fields
  int frames = 0;                ///< frames to come, beside the initial one
  int history_capacity = 0;      ///< largest number of history rows
  std::vector<std::int64_t> nodes, elements;  ///< of each layer's mesh; empty: not told
};

/// Sent once by the coordinator when the run ends.
struct RunEnd {
  std::string status;   ///< "done", "diverged", "lost", "cancelled", "failed"
  std::string message;  ///< one sentence
  std::string digest;   ///< final state of all layers, hex; empty unless done
  int frames_complete = 0;  ///< frames, initial one included, that every layer was told to publish
  std::string summary;      ///< numbers of the summary, JSON; may be empty
};

/// Where a participant puts what may be watched. Calls never block the step for long and never throw on a lost reader.
class Sink {
 public:
  virtual ~Sink() = default;
  virtual void put(const RunHeader&) = 0;
  virtual void put(const LayerMesh&) = 0;
  virtual void put(const LayerFrame&) = 0;
  virtual void put(const InterfaceFrame&) = 0;
  virtual void put(const ToolFrame&) = 0;
  virtual void put(const HistoryRow&) = 0;
  virtual void put(const RunEnd&) = 0;
  /// Waits until everything put so far has been received (DDS acknowledgement) or `seconds` have passed.
  virtual bool flush(double seconds) = 0;
  /// Why it keeps nothing any more, one sentence; empty: it does.
  virtual std::string failure() const { return {}; }
};

}  // namespace interply::observe
