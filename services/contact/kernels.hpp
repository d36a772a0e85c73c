/// The kernels of contact, several points at once (simd/target.hpp), and the arrays they work on.
#pragma once

#include <cstddef>

#include "contact/law.hpp"
#include "contact/node.hpp"
#include "simd/target.hpp"

namespace interply::contact {

/// Rows of a [3 x n] array.
struct ConstRows {
  const double *x, *y, *z;
};
struct Rows {
  double *x, *y, *z;
};

/// The points of an interface, as in Points.
struct PointRows {
  const double* area;
  double *gap, *weight, *pressure, *slip, *friction_work, *height;
  Rows stick;
  int* state;
};

/// Nodes of a lower layer against the surface of an upper one.
struct PairRows {
  InterfaceLaw law;
  double dt;  ///< s; 0 at the start of a run
  const Node *lower, *upper;
  const int *corner[3], *neighbour[3];  ///< of the triangles of `upper`
  int* triangle;                        ///< that each node faces [n]
  PointRows points;
  Quad* lower_force;       ///< force on node i of the lower layer and pull on its normal, in 2 i and 2 i + 1
  unsigned char* touches;  ///< 0: nothing acts at point i [n]
  void* owner;
  /// Called for node i if it has left its triangle near the partner's edge or goes far: finds the one it faces now and
  /// returns the corner opposite the edge that the node is beyond, or -1; adds what the change puts into the springs to
  /// `edge`, mJ.
  int (*walk)(void* owner, std::ptrdiff_t i, double& edge);
};

struct ContactKernels {
  /// Advances the points [begin, end) and fills the forces: those on the upper layer, of the corners k of the facet
  /// that point begin + i faces, into 6 i + 2 k (on the node) and 6 i + 2 k + 1 (on its normal) of `upper_force` if the
  /// point touches. Adds to all energies but the work.
  void (*advance_pairs)(const PairRows& pair, std::ptrdiff_t begin, std::ptrdiff_t end, Quad* upper_force,
                        InterfaceEnergies& energies);
  /// Adds them to the records of the nodes of the upper layer in the order of the points: which corners they add to
  /// changes as they slide.
  void (*add_upper_forces)(const PairRows& pair, std::ptrdiff_t begin, std::ptrdiff_t end, const Quad* upper_force,
                           Quad* records);
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
