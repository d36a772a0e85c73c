/// Laws of the test libraries (tests/support/vumat) with the parameters of built-in ones.
#pragma once

#include <algorithm>
#include <string>

#include "paths.hpp"
#include "scene/scene.hpp"

namespace interply::test {

inline scene::VumatLaw make_vumat(const std::string& name, std::vector<double> parameters, int state_variables = 0) {
  return {.library = {.path = INTERPLY_VUMAT_DIR "/lib" + name + ".so", .digest = ""},
          .parameters = std::move(parameters),
          .state_variables = state_variables};
}

/// woven.f90 with the couplings of the variant; state 1 is the shear angle.
inline scene::VumatLaw make_woven_vumat(const scene::WovenLaw& w) {
  const bool biaxial = w.variant == scene::Variant::Full || w.variant == scene::Variant::Biaxial;
  const bool shear = w.variant == scene::Variant::Full || w.variant == scene::Variant::NormalShear;
  const auto cap = [](double strain) { return std::min(strain, 1e9); };
  std::vector<double> props{w.a.warp, w.a.weft, w.b.warp, w.b.weft};
  for (const scene::Pair& x : {biaxial ? w.c : scene::Pair{0, 0}, biaxial ? w.p_min : scene::Pair{1, 1}, w.d})
    props.insert(props.end(), {x.warp, x.weft});
  props.insert(props.end(), w.s.begin(), w.s.end());
  for (const scene::Pair& x : {shear ? w.s_T : scene::Pair{0, 0}, shear ? w.s_C : scene::Pair{0, 0}})
    props.insert(props.end(), {x.warp, x.weft});
  props.insert(props.end(), {cap(w.strain_cap.warp), cap(w.strain_cap.weft)});
  return make_vumat("woven", props, 1);
}

/// j2.for with Swift hardening; state 1 is the equivalent plastic strain.
inline scene::VumatLaw make_j2_vumat(const scene::J2Law& law, scene::Integration integration) {
  const auto& h = std::get<scene::Swift>(law.hardening);
  auto own = make_vumat("j2", {law.young, law.poisson, h.K, h.e0, h.n}, 1);
  own.integration = integration;
  return own;
}

/// faulty.f90: elastic with nu = 0 until `time`, then it fails.
enum Fault {
  kNoFault, kNotANumber, kAbort, kStop, kExit, kExitAtOnce, kNullPointer, kNeverReturns, kStackOverflow, kFifthState,
  kSixStresses, kWordBefore, kChangesInput, kCounter, kStress33, kErrorRoutine, kExitRoutine
};
inline scene::VumatLaw make_faulty_vumat(double young, int fault = 0, double time = 1e9) {
  return make_vumat("faulty", {young, static_cast<double>(fault), time});
}

}  // namespace interply::test
