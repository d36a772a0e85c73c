/// The kernel of nodes against a tool, several at once (simd/target.hpp), and what it works on.
#pragma once

#include <cstddef>

#include "contact/kernels.hpp"

namespace interply::contact {

/// Regular triangle around the origin that is symmetric about y = 0, one corner on the positive x axis.
struct TriangleShape {
  double half_edge;  ///< mm
  double inradius;   ///< half_edge/sqrt(3), mm
};

/// OpeningPlate in plain numbers.
struct PlateShape {
  TriangleShape opening;
  double offset, shoulder;  ///< mm
  double land;              ///< offset + shoulder: distance from the triangle at which the flat land begins, mm
  double up;                ///< 1: the plate faces up; -1: down
};

/// PyramidPunch in plain numbers. The plane of symmetry of a face of the pyramid is that of a coordinate out, away from
/// the axis, and of z; lines and planes are named there, from the apex.
struct PunchShape {
  TriangleShape base;
  double radius;                   ///< of the ball, mm
  double height;                   ///< of the pyramid, mm
  double normal_out, normal_up;    ///< of the face; (-normal_up, normal_out) leads from the apex down the middle of it
  double slant;                    ///< from the apex to the middle of the base edge, mm
  double edge_slant, edge_across;  ///< unit vector from the apex to a corner of the base, in the face
  double edge_length;              ///< from the apex to a corner of the base, mm
};

/// Any other tool.
struct AnyShape {
  const void* tool;
  /// Value and gradient of its distance at x.
  void (*evaluate)(const void* tool, const double x[3], double distance[4]);
};

/// What the kernel needs to know of a SignedDistance.
struct ToolShape {
  enum class Kind { Any, Plate, Punch } kind;
  AnyShape any;
  PlateShape plate;
  PunchShape punch;
};

/// Nodes of a layer against a tool.
struct ToolRows {
  InterfaceLaw law;
  double dt;         ///< s; 0 at the start of a run
  double z;          ///< height of the tool's reference point, mm
  double increment;  ///< of the same, mm
  double margin;     ///< gap at which a node has no slack left, mm
  const Node* layer;
  double* slack;  ///< path that the node may still move relative to the tool before it is looked at again [n] mm
  PointRows points;
  Quad* force;  ///< force on node i and pull on its normal, in 2 i and 2 i + 1
};

/// What some points of a tool add up to.
struct ToolSums {
  InterfaceEnergies energies;
  double force[3] = {};   ///< on the layer, N
  double moment[3] = {};  ///< of the same about the origin, N mm
  bool touches = false;   ///< one of them does or did; else no force acts
};

struct ToolKernels {
  /// Advances the points [begin, end) and fills the forces. Nodes with slack left lose the path of the step from it and
  /// are not looked at: their points stay as they are. Of those that were open and stay so only gap and height change.
  ToolSums (*advance)(const ToolShape& shape, const ToolRows& tool, std::ptrdiff_t begin, std::ptrdiff_t end);
};

template <class Target>
const ToolKernels& get_tool_kernels();
template <>
const ToolKernels& get_tool_kernels<simd::Scalar>();
template <>
const ToolKernels& get_tool_kernels<simd::Avx2>();
template <>
const ToolKernels& get_tool_kernels<simd::Avx512>();

inline const ToolKernels& choose_tool_kernels() {
  return simd::choose([](auto t) -> const ToolKernels& { return get_tool_kernels<decltype(t)>(); });
}

}  // namespace interply::contact
