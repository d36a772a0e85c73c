/// Kinematics of the rotation-free basic shell triangle (BST), shared by both solvers.
///
/// Source: Onate & Zarate, Int. J. Numer. Meth. Engng 47 (2000); Flores & Onate, CMAME 194 (2005). The curvature of a
/// triangle M follows from the surface gradients phi^I of its three neighbours I and its own unit normal t3,
///
///   kappa_ab = -sym sum_I L^I_,a (phi^I_,b . t3)                                                       (B1)
///
/// with L^I_,a = dN_I/dX_a of M (the side opposite I has the outward normal -grad N_I). kappa > 0 where the surface
/// bends towards +t3 (kappa_ab = phi_,ab . t3). Its variation moves all six patch nodes along t3 only. Free edge: the
/// missing side is dropped. Symmetry edge: the neighbour is the triangle's own mirror image in y = 0. All gradients
/// refer to an in-plane reference frame turned by `angle` from x (the fibre frame of a ply).
#pragma once

#include "mechanics/mesh.hpp"

namespace interply::mechanics {

/// Reference geometry of all patches; rows over the patch's constants, elements innermost.
struct ShellPatches {
  /// Corners 0-2; 3-5 the far corner across side k, or the own corner k where the side is free or mirrored. [6 x n_el]
  Eigen::Array<int, 6, Eigen::Dynamic, Eigen::RowMajor> nodes;
  /// Factor on y of far corner k: -1 at a mirrored side, else +1. [3 x n_el]
  Eigen::Array<double, 3, Eigen::Dynamic, Eigen::RowMajor> mirror_y;
  /// dN_k/dX_a of the own triangle, row 2k + a. [6 x n_el] 1/mm
  Eigen::Array<double, 6, Eigen::Dynamic, Eigen::RowMajor> gradient;
  /// Gradient of neighbour I as weights on its corners (patch nodes (I+1)%3, (I+2)%3, 3+I), row 6I + 2m + a;
  /// zero where the side is free. [18 x n_el] 1/mm
  Eigen::Array<double, 18, Eigen::Dynamic, Eigen::RowMajor> side_gradient;
  Scalars area;      ///< reference area [n_el] mm2
  Incidence gather;  ///< over 6 slots per element

  Eigen::Index n_elements() const { return area.size(); }
};

/// @param angle  direction of the frame's first axis from x, rad
ShellPatches make_shell_patches(const TriangleMesh& mesh, double angle);

/// Deformation of one triangle: columns of F and its unit normal.
struct SurfaceGradient {
  Vector3 f1, f2;         ///< F e1, F e2
  Vector3 t3;             ///< unit normal f1 x f2 / |f1 x f2|
  double area_ratio = 0;  ///< J = |f1 x f2|
};

/// F = sum_k x_k (x) dN_k of element `e`.
inline SurfaceGradient compute_surface_gradient(const ShellPatches& p, const NodalVectors& x, Eigen::Index e) {
  SurfaceGradient g{Vector3::Zero(), Vector3::Zero(), Vector3::Zero(), 0};
  for (int k = 0; k < 3; ++k) {
    const Vector3 xk = at(x, p.nodes(k, e));
    g.f1 += p.gradient(2 * k, e) * xk;
    g.f2 += p.gradient(2 * k + 1, e) * xk;
  }
  const Vector3 n = g.f1.cross(g.f2);
  g.area_ratio = n.norm();
  g.t3 = n / g.area_ratio;
  return g;
}

/// kappa = (kappa_11, kappa_22, kappa_12) and what its variation needs.
struct Curvature {
  double k11 = 0, k22 = 0, k12 = 0;  ///< 1/mm
  /// rho[I](b, c): component of neighbour gradient phi^I_,b along the own dual vector of f_c
  Matrix2 rho[3];
};

Curvature compute_curvature(const ShellPatches& p, const NodalVectors& x, Eigen::Index e, const SurfaceGradient& g);

/// Nodal forces, conjugate to the patch nodes, of the moments m = (m11, m22, m12) per unit reference width, N.
/// Work rate per reference area: m11 k11' + m22 k22' + 2 m12 k12'. Writes the magnitude along t3 for the six patch
/// nodes (mirrored far corners: before reflection) into `along_t3`.
void compute_bending_forces(const ShellPatches& p, Eigen::Index e, const Curvature& k, double m11, double m22,
                            double m12, double along_t3[6]);

/// Largest |B|^2 of the curvature operator in the flat reference, per element: for bounding the bending frequency.
/// [n_el] 1/mm4, sum over patch nodes of (dk11^2 + dk22^2 + 2 dk12^2)
Scalars compute_curvature_operator_norms(const ShellPatches& p);

}  // namespace interply::mechanics
