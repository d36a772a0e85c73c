/// Outline of a triangular opening, and how much of a blank lies inside it.
#pragma once

#include <array>
#include <vector>

#include "mechanics/mesh.hpp"

namespace interply::geometry {

using Outline = std::vector<std::array<double, 2>>;  ///< corners of a convex polygon, counter-clockwise, mm

/// A regular triangle of edge `edge`, centred on the origin with a corner on +x, offset outwards by `offset`: its three
/// corners become arcs, each divided into `parts`. All corners of the polygon lie on the outline.
Outline trace_opening(double edge, double offset, int parts);

double compute_area(const Outline& outline);

/// Area of the part of a flat mesh that lies inside a convex outline, mm2. Exact.
double compute_area_inside(const mechanics::TriangleMesh& mesh, const Outline& outline);

}  // namespace interply::geometry
