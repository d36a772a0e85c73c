/// Parameters of the woven laws (woven_law.hpp) in the form that kernels take.
#pragma once

namespace interply::fabric {

/// Parameters of one fibre direction (scene::WovenLaw).
struct FibreParameters {
  double a = 0, b = 0, c = 0, p_min = 1, d = 0, s_T = 0, s_C = 0, strain_cap = 0;
};

/// Of the invariant-based law.
struct InvariantParameters {
  FibreParameters warp, weft;
  double s[3] = {};  ///< MPa
};

/// A piecewise linear curve and its integral from 0 at its `n` points.
struct CurveView {
  const double *x = nullptr, *value = nullptr, *integral = nullptr;
  int n = 0;
};

/// Of variant `fabric`.
struct TableParameters {
  CurveView warp, weft, shear;
};

}  // namespace interply::fabric
