/// Material laws of a user's own: a shared library with the entry point of the Abaqus/Explicit user subroutine VUMAT.
///
/// The symbol `vumat_` (as gfortran names it) or `vumat` is called with the standard argument list in double precision,
/// arrays (nblock, components) column-major, for up to kVumatBlock points at once and from one thread at a time. Fixed:
/// ndir = 3, nshr = 1, nfieldv = 0, lanneal = 0, no temperature. State variables, stress and energies are zero at the
/// start. What differs from solids, and where we had to choose:
///
/// - **Basis.** With F = R U in the tangent plane, vectors and tensors are components in R e1, R e2, normal, with e1
/// the
///   warp (or rolling direction) and e2 across it in the reference plane: the polar (Green-Naghdi) frame. In it F is
///   symmetric, so stretch = (U11, U22, F33, U12) and defgrad = (U11, U22, F33, U12, U12).
/// - **Strain.** strainInc holds tensor components of the increment of the logarithmic strain, of second order,
///       de = Um^-1 (C_new - C_old)/2 Um^-1,   Um^2 = (C_old + C_new)/2                                   (V1)
///   relSpinInc is the 3-component of the rotation of the material relative to the frame, skew(dU Um^-1).
/// - **Thickness.** Plane stress: stressNew(:,3) is ignored. strainInc(:,3) arrives as zero; what the law leaves there
///   is the thickness strain increment, F33 = exp(sum). A law that leaves it alone keeps the thickness. defgradNew and
///   stretchNew still show the F33 of the beginning.
/// - **Stress** is Cauchy. The force per reference length follows from S t0 = t0 J F33 U^-1 sigma U^-1.
/// - density is current, without mass scaling; charLength = sqrt(current area); coordMp the element's centre on the
///   midsurface; stepTime = totalTime = time at the end of the increment; cmname the layer's name in capitals.
/// - enerInternNew and enerInelasNew are carried along and used for nothing: the layer books the stress work itself.
/// - **Tangent.** As Abaqus does before it starts, the law is called with stepTime = totalTime = 0 and small made-up
///   strains, and again from the current state at every vote; what it returns then is thrown away, so a law must keep
///   its history in the state variables and nowhere else.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "mechanics/digest.hpp"
#include "mechanics/nodal.hpp"
#include "scene/scene.hpp"
#include "solve/layer_mechanics.hpp"

namespace interply::solve {

inline constexpr int kVumatBlock = 128;  ///< points per call; Abaqus uses up to 136

/// What one point does in one increment, in the basis of (V1).
struct VumatIncrement {
  mechanics::Matrix2 strain;             ///< de of (V1)
  mechanics::Matrix2 stretch;            ///< U at the end
  double spin = 0;                       ///< relSpinInc, rad
  mechanics::Vector3 position{0, 0, 0};  ///< mm
  double length = 1;                     ///< charLength, mm
};

/// U = sqrt(C) of a positive definite metric, by Cayley-Hamilton.
mechanics::Matrix2 compute_stretch(const mechanics::Matrix2& metric);

/// (V1) from the stretch at the start to the metric at the end.
VumatIncrement compute_vumat_increment(const mechanics::Matrix2& old_stretch, const mechanics::Matrix2& new_metric);

/// Stress sigma (MPa) and F33 of a point.
struct VumatResponse {
  mechanics::Matrix2 stress;
  double thickness_stretch = 1;
};

/// The library is there and has the entry point.
/// @throws scene::SceneError naming library, cause and cure
void check_vumat(const scene::VumatLaw& law, const std::string& layer);

/// The points of one layer: the law and its history.
class VumatPoints {
 public:
  /// @param density  without mass scaling, t/mm3
  /// @throws scene::SceneError as check_vumat(), or if the law does not resist small strains
  VumatPoints(const scene::VumatLaw& law, const std::string& layer, double density, Eigen::Index n_points);
  ~VumatPoints();

  /// Advances the points [first, first + n); n <= kVumatBlock. Not from two threads. A law that fails shows as stress
  /// or thickness that is not finite.
  void advance(Eigen::Index first, int n, const VumatIncrement* increments, const Instant& now);
  /// The same call with everything that it returns thrown away.
  void rehearse(Eigen::Index first, int n, const VumatIncrement* increments, const Instant& now);

  Eigen::Index size() const { return stress_.cols(); }
  VumatResponse response(Eigen::Index point) const;
  mechanics::Matrix2 stretch(Eigen::Index point) const;
  int n_state() const { return static_cast<int>(state_.rows()); }
  double state(int variable, Eigen::Index point) const { return state_(variable, point); }

  /// d sigma / d(e11, e22, 2 e12) of the points [first, first + n), symmetric part, MPa: each column from a small
  /// strain to either side, of which the stiffer counts (unloading, where the law is plastic).
  /// @param increments  position and length of the points
  void compute_tangents(Eigen::Index first, int n, const VumatIncrement* increments, const Instant& now,
                        Eigen::Matrix3d* tangents);
  /// The same of the undeformed material, from the calls with stepTime = 0: no vote goes below it, so that slack fibres
  /// do not vote for a large increment.
  const Eigen::Matrix3d& initial_tangent() const { return initial_tangent_; }

  /// Stress, thickness and state variables.
  void add_state_to(mechanics::Digest& digest) const;

 private:
  struct Block;
  using Rows = Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  void call(Eigen::Index first, int n, const VumatIncrement* increments, const Instant& now);
  VumatResponse called(int i) const;

  void* entry_ = nullptr;
  std::shared_ptr<void> library_;  // fills in entry_
  std::array<char, 80> name_{};
  std::vector<double> parameters_;
  double density_;                 // t/mm3
  Rows stress_, stretch_, state_;  // (11, 22, 33, 12), (U11, U22, F33, U12), variables [rows x n_points]
  Rows energy_;                    // enerIntern, enerInelas [2 x n_points]
  Eigen::Matrix3d initial_tangent_;
  std::unique_ptr<Block> block_;  // arguments of one call
};

}  // namespace interply::solve
