/// The kernels of contact, several points at once (simd/target.hpp), and the arrays they work on.
#pragma once

#include <cstddef>

#include "contact/law.hpp"
#include "contact/quad.hpp"
#include "simd/target.hpp"

namespace interply::contact {

/// Rows of a [3 x n] array.
struct ConstRows {
  const double *x, *y, *z;
};
struct Rows {
  double *x, *y, *z;
};

/// A layer at one instant, as in LayerGeometry.
struct LayerRows {
  ConstRows position, increment, normal, turn;
  const double* half_thickness;
};

/// The points of an interface, as in Points.
struct PointRows {
  const double* area;
  double *gap, *weight, *pressure, *damping, *slip, *height;
  Rows stick, traction;
  int* state;
};

/// Nodes of a lower layer against the surface of an upper one.
struct PairRows {
  InterfaceLaw law;
  double dt;  ///< s; 0 at the start of a run
  LayerRows lower, upper;
  const int* corner[3];  ///< of the triangles of `upper`
  const int* triangle;   ///< that each node faces [n]
  PointRows points;
  Quad* lower_force;       ///< force on node i of the lower layer and pull on its normal, in 2 i and 2 i + 1
  Quad* upper_force;       ///< the same for the corners k of the triangle, in 6 i + 2 k and 6 i + 2 k + 1
  unsigned char* touches;  ///< 0: nothing acts at point i, and its `upper_force` is not filled [n]
  void* owner;
  /// Called for node i if it has left its triangle: finds the one it faces now and returns the corner opposite the
  /// partner's edge that the node is beyond, or -1; adds what the change puts into the springs to `edge`, mJ.
  int (*walk)(void* owner, std::ptrdiff_t i, double& edge);
};

/// Nodes of a layer against a tool whose distances are known.
struct ToolRows {
  InterfaceLaw law;
  double dt;         ///< s; 0 at the start of a run
  double increment;  ///< of the tool along z, mm
  LayerRows layer;
  ConstRows gradient;  ///< of the distance [n]
  const double* gap;   ///< [n] mm
  PointRows points;
  Quad* force;  ///< force on node i and pull on its normal, in 2 i and 2 i + 1
};

/// What some points of a tool add up to.
struct ToolSums {
  InterfaceEnergies energies;
  double force[3] = {};   ///< on the layer, N
  double moment[3] = {};  ///< of the same about the origin, N mm
};

struct ContactKernels {
  /// Advances the points [begin, end) and fills the forces. Points that were open and stay so are left as they are, but
  /// for gap, height and their force, zero.
  ToolSums (*advance_tool)(const ToolRows& tool, std::ptrdiff_t begin, std::ptrdiff_t end);
  /// Advances the points [begin, end) and fills the forces. Adds to all energies but the work.
  void (*advance_pairs)(const PairRows& pair, std::ptrdiff_t begin, std::ptrdiff_t end, InterfaceEnergies& energies);
};

template <class Target>
const ContactKernels& get_contact_kernels();
template <>
const ContactKernels& get_contact_kernels<simd::Scalar>();
template <>
const ContactKernels& get_contact_kernels<simd::Avx2>();
template <>
const ContactKernels& get_contact_kernels<simd::Avx512>();

inline const ContactKernels& choose_contact_kernels() {
  return simd::choose([](auto t) -> const ContactKernels& { return get_contact_kernels<decltype(t)>(); });
}

}  // namespace interply::contact
