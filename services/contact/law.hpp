/// Constants of the contact law, and what its points add up to. Plain numbers, for kernels too.
#pragma once

namespace interply::contact {

/// Everything per area of the interface, so that a result does not change with the mesh.
struct InterfaceLaw {
  double stiffness = 0;   ///< k    pressure per penetration                     N/mm3
  double tangential = 0;  ///< k_t  tangential traction per elastic slip         N/mm3
  double damping = 0;     ///< c    pressure per closing speed, while touching   N s/mm3
  double friction = 0;    ///< mu
};

/// Passed: the node left the partner across its edge, came by the far side, and is on its way past: nothing acts until
/// it is back on its own side. Without this a node that returns above the partner would be a penetration of
/// millimetres.
enum class State : int { Open = 0, Stick = 1, Slide = 2, Passed = 3 };

/// Share of an element by which a node may leave the partner's edge and still be held.
inline constexpr double kEdgeMargin = 0.3;
/// Depth, as a share of the height at which a pair touches, from which a node beyond the edge has passed.
inline constexpr double kPassedDepth = 0.5;
/// Weight below which a node has left its triangle: on a side it stays with the triangle it has.
inline constexpr double kOnSide = -1e-9;
/// All weights are within this of those of a corner: the node stays too. Nodes of matching meshes lie at corners, and
/// every vibration would have them walk. All facets around a corner have the same tangent plane there: at 1e-4 of an
/// element their distances differ by 1e-8 of its sagitta.
inline constexpr double kAtCorner = 1e-4;

/// Energies of one interface since the start, mJ; each accumulated from its own quantities.
struct InterfaceEnergies {
  double stored = 0;    ///< penalty and stick springs, a state function
  double friction = 0;  ///< dissipated by slip
  double damping = 0;   ///< dissipated by contact damping
  double thinning = 0;  ///< put in by growing (> 0) or thinning (< 0) layers
  double edge = 0;      ///< put in by the springs of nodes that pass the partner's edge, where the pair itself changes
  double work = 0;      ///< done by the contact forces on both partners, trapezoid over their displacement increments

  /// What the books do not explain; zero for a perfect balance.
  double residual() const { return stored + friction + damping - thinning - edge + work; }
  void add(const InterfaceEnergies& e) {
    stored += e.stored;
    friction += e.friction;
    damping += e.damping;
    thinning += e.thinning;
    edge += e.edge;
    work += e.work;
  }
};

}  // namespace interply::contact
