/// Material laws of a user's own: a shared library with the entry point of the Abaqus/Explicit user subroutine VUMAT.
///
/// The symbol `vumat_` (as gfortran names it) or `vumat` is called with the standard argument list in double precision,
/// arrays (nblock, components) column-major, for up to kVumatBlock points at once and from one thread at a time. The
/// points of a call have one section point, the elements rise by one. What the documented interface has for shells and
/// membranes, and what arrives here:
///
///   nblock or jblock    (1) points of the call, (2) material point 1, (3) layer 1, (4) section point from 1 at the
///                       bottom, (5...) element numbers from 1
///   ndir, nshr          3, 1
///   nstatev, nprops     state_variables, number of parameters;   props: parameters
///   lanneal/jInfoArray  zeros;   nfieldv 0: fieldOld and fieldNew are empty
///   stepTime, totalTime time at the end of the increment, s; both 0 in the calls before the start
///   dt or dtArray       (1) the increment, never 0; the rest of dtArray is zero (no modulus of the law's own)
///   cmname              the layer's name in capitals, filled up with blanks
///   coordMp             the element's centre on the midsurface, mm
///   charLength          sqrt(current area), mm
///   density             current, without mass scaling, t/mm3
///   strainInc           (11, 22, 33, 12), tensor components, see below;   relSpinInc, rad
///   tempOld, tempNew    zeros
///   stretchOld/New      (U11, U22, F33, U12);   defgradOld/New (U11, U22, F33, U12, U12)
///   stressOld, stateOld, enerInternOld, enerInelasOld   zero at the start, then what the law returned
///   stressNew           Cauchy (11, 22, 33, 12), MPa, to be written;   33 must be 0
///   stateNew            to be written
///   enerInternNew, enerInelasNew   carried along and used for nothing: the layer books the stress work itself
///
/// Not there: transverse shear, temperature, field variables, annealing, element deletion (a state variable that says
/// so stays a number), single precision. Routines that Abaqus would call beside VUMAT and that change what it computes
/// (VEXTERNALDB, VUSDFLD, ...) are refused by name, others named in a warning; vumat_utilities.hpp lists what a law
/// may call. What differs from solids, and where we had to choose:
///
/// - **Basis.** With F = R U in the tangent plane, vectors and tensors are components in R e1, R e2, normal, with e1
///   the warp (or rolling direction) and e2 across it in the reference plane: the polar (Green-Naghdi) frame. In it F
///   is symmetric.
/// - **Strain.** strainInc holds tensor components of the increment of the logarithmic strain, of second order,
///       de = Um^-1 (C_new - C_old)/2 Um^-1,   Um^2 = (C_old + C_new)/2                                   (V1)
///   relSpinInc is the 3-component of the rotation of the material relative to the frame, skew(dU Um^-1).
/// - **Thickness.** Plane stress: stressNew(:,3) must stay zero; a law that gives another is refused by probe_vumat().
///   strainInc(:,3) arrives as zero; what the law leaves there is the thickness strain increment, F33 = exp(sum). A law
///   that leaves it alone keeps the thickness. defgradNew and stretchNew still show the F33 of the beginning.
/// - **Force** per reference length follows from S t0 = t0 J F33 U^-1 sigma U^-1.
/// - **Tangent.** As Abaqus does before it starts, the law is called with stepTime = totalTime = 0 and small made-up
///   strains, and again from the current state at every vote; what it returns then is thrown away, so a law must keep
///   its history in the state variables and nowhere else.
/// - **Guard words** lie before and behind every array. A law that writes there (a law for solids, or one that needs
///   more state variables) ends the run by name and harms nothing.
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "mechanics/digest.hpp"
#include "mechanics/nodal.hpp"
#include "scene/scene.hpp"
#include "solve/law_guard.hpp"
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

/// The points of one layer: the law and its history.
class VumatPoints {
 public:
  /// Point e of section point s (from 0) is number s * n_elements + e.
  /// @param density  without mass scaling, t/mm3
  /// @throws scene::SceneError naming library, cause and cure if the library cannot be used, or does not resist small
  ///         strains
  VumatPoints(const scene::VumatLaw& law, const std::string& layer, double density, Eigen::Index n_elements,
              int n_sections = 1);
  ~VumatPoints();

  /// Advances the points [first, first + n) of one section point; n <= kVumatBlock. Not from two threads. A law that
  /// fails shows as stress or thickness that is not finite.
  /// @throws mechanics::Divergence where the law has written outside its arrays
  void advance(Eigen::Index first, int n, const VumatIncrement* increments, const Instant& now);
  /// The same call with everything that it returns thrown away.
  void rehearse(Eigen::Index first, int n, const VumatIncrement* increments, const Instant& now);

  /// Advances all points by small made-up strains and looks at everything that the law touches.
  /// @return warnings: read-only arguments that it changes, answers that depend on something beside the arguments
  /// @throws scene::SceneError  it writes outside its arrays, gives stress 33 or stress that is not finite
  std::vector<std::string> examine();

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

  /// Largest |stress 33| so far that is more than round-off, MPa; 0 for a law for plane stress.
  double largest_stress_33() const;

  /// Stress, thickness and state variables.
  void add_state_to(mechanics::Digest& digest) const;

 private:
  struct Block;
  using Rows = Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  void fill(Eigen::Index first, int n, const VumatIncrement* increments, const Instant& now);
  void invoke();
  void call(Eigen::Index first, int n, const VumatIncrement* increments, const Instant& now);
  mechanics::Matrix2 called_stress(int i) const;
  void check_fences(Eigen::Index first, int n) const;

  LawName law_;
  void* entry_ = nullptr;
  std::shared_ptr<void> library_;  // fills in entry_ and law_.flush
  std::array<char, 80> name_{};
  std::vector<double> parameters_;
  double density_;  // t/mm3
  Eigen::Index n_elements_;
  Rows stress_, stretch_, state_;  // (11, 22, 33, 12), (U11, U22, F33, U12), variables [rows x n_points]
  Rows energy_;                    // enerIntern, enerInelas [2 x n_points]
  Eigen::Matrix3d initial_tangent_;
  double stress_33_ = 0;          // largest so far
  std::unique_ptr<Block> block_;  // arguments of one call
};

}  // namespace interply::solve
