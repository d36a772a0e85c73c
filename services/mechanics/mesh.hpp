/// Flat triangle mesh of one blank and what follows from its connectivity.
#pragma once

#include <array>
#include <vector>

#include "mechanics/nodal.hpp"

namespace interply::mechanics {

/// A flat blank in a plane z = const; corners counter-clockwise seen from +z.
struct TriangleMesh {
  NodalVectors reference;           ///< X   midsurface nodes of the flat blank            [3 x n_nodes]     mm
  Triangles triangles;              ///< corners                                           [3 x n_elements]
  Triangles neighbours;             ///< element across the side opposite corner k, or -1  [3 x n_elements]
  std::vector<int> symmetry_nodes;  ///< nodes held in the symmetry plane y = 0, ascending
  std::vector<int> clamped_nodes;  ///< boundary sides between two of these keep their slope; who holds them is not said

  Eigen::Index n_nodes() const { return reference.cols(); }
  Eigen::Index n_elements() const { return triangles.cols(); }
};

/// Which diagonals of the grid of a rectangular blank run through its centre: all four that could, or none.
enum class Diagonals { Centre, Around };

/// Rectangular blank centred on the origin: right triangles on a regular grid, legs along x and y, diagonals
/// alternating like a chequerboard. Cells and diagonals are counted from the centre, round(length/2h) cells (at least
/// one) to either side along x and along y, so that the mesh is its own mirror image in both axes and the half model's
/// mesh is one half of the full one's, node by node, whatever the mesh size. Nodes run with x fastest.
/// @param length, width  along x and y, mm
/// @param h              wanted mesh size, mm
/// @param z              height of the midsurface, mm
/// @param half           only y >= 0; the nodes at y = 0 are held in that plane
TriangleMesh make_blank(double length, double width, double h, double z, bool half, Diagonals diagonals);

/// Cells of such a blank to one side of its centre, along one of its sides.
int count_cells_from_centre(double side, double h);

/// Any rectangle with diagonals that alternate from its corner (x[0], y[0]), the first cell's starting there. Sides are
/// divided into round(length/h) cells, at least one.
/// @param x, y   {min, max} of the rectangle, mm
/// @param h      wanted mesh size, mm
/// @param z      height of the midsurface, mm
/// @param symmetric  hold the nodes at y = 0 in the plane y = 0 (@pre y[0] == 0 then)
TriangleMesh make_rectangle(std::array<double, 2> x, std::array<double, 2> y, double h, double z = 0.0,
                            bool symmetric = false);

/// A flat blank from points and counter-clockwise triangles of any outline.
/// @param points     x, y of each node                          [n_nodes]     mm
/// @param triangles  corners, from 0                            [n_elements]
/// @param z          height of the midsurface, mm
/// @param half       the mesh is the part y >= 0 of a blank that is mirrored in y = 0: nodes within 1e-6 of the size of
///                   the blank of that plane are put into it and held there
/// @throws std::invalid_argument  a half with nodes at y < 0 or with none at y = 0; see also find_neighbours()
TriangleMesh make_mesh(const std::vector<std::array<double, 2>>& points,
                       const std::vector<std::array<int, 3>>& triangles, double z, bool half);

/// Element across each side. Non-manifold sides (three or more triangles) throw std::invalid_argument.
Triangles find_neighbours(const Triangles& triangles, Eigen::Index n_nodes);

/// Reference area of each triangle (positive for counter-clockwise corners). [n_elements] mm2
Scalars compute_areas(const TriangleMesh& mesh);

/// A third of the area of the triangles around each node. [n_nodes] mm2
Scalars compute_tributary_areas(const TriangleMesh& mesh);

/// Lumped mass: density x thickness x tributary area. [n_nodes] t
Scalars compute_lumped_mass(const TriangleMesh& mesh, double thickness, double density);

/// For each node the (element, slot) pairs that touch it, elements ascending: gathers element values in an order that
/// does not depend on the number of threads.
struct Incidence {
  std::vector<int> start;  ///< first entry of node i in `entry`  [n_nodes + 1]
  std::vector<int> entry;  ///< slot * n_elements + element       [total]
};

/// Incidence of `slots` node numbers per element; `nodes` is [slots x n_elements] row-major, negative entries skipped.
Incidence make_incidence(const int* nodes, int slots, Eigen::Index n_elements, Eigen::Index n_nodes);

/// force_i = sum of the element values of node i in the order of the incidence, for nodes [begin, end).
/// @param slot_force  value of slot s of element e in column s * n_elements + e [3 x slots * n_elements]
void gather_forces(const Incidence& incidence, const NodalVectors& slot_force, Eigen::Index begin, Eigen::Index end,
                   NodalVectors& force);

}  // namespace interply::mechanics
