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

/// What acts at the facing nodes of the lower layer (of the only one, against a tool), and on the layer above it.
struct InterfaceFrame {
  std::string interface;  ///< "lower|upper", e.g. "ply_1|ply_2", "die|sheet_lower"
  std::string nodes_of;   ///< layer whose nodes carry the fields
  int frame = 0;
  std::int64_t step = 0;
  double time = 0;
  std::vector<Field> fields;  ///< pressure, tangential_traction [3], force [3], gap, slip, state, ... (RECORD.md)
  std::vector<Field> fields_on_other;  ///< at the nodes of the other layer; none against a tool
};

struct ToolFrame {
  std::string tool;
  int frame = 0;
  std::int64_t step = 0;
  double time = 0;
  double position = 0;   ///< z of the tool's reference point, mm
  double force[3] = {};   ///< contact force on the tool, full modelled part, N
  double moment[3] = {};  ///< of the same about the origin, N mm
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
  std::vector<double> interface_residual, interface_friction;  ///< per interface, mJ
};

/// Triangles of a tool for pictures, relative to its reference point.
struct ToolSurface {
  mechanics::NodalVectors nodes;   ///< [3 x n_nodes] mm
  mechanics::Triangles triangles;  ///< counter-clockwise seen from outside [3 x n_triangles]
};

/// Sent once by the coordinator before anything else.
struct RunHeader {
  std::string run;               ///< unique name of this execution
  std::string scene_text, version, scene_digest;
  std::vector<std::string> layers, interfaces, tools;  ///< in order; every frame and history row refers to these
  std::vector<std::string> interface_nodes_of;         ///< layer whose nodes carry each interface's fields
  std::vector<std::string> interface_others;           ///< layer or tool on its other side
  std::vector<ToolSurface> tool_surfaces;              ///< of each tool
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
  std::string summary;      ///< every number of the summary with its unit (proto/summary.proto); empty unless done
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
