/// Smooth amplitudes of tools and loads.
#pragma once

#include <algorithm>

namespace interply::coordinator {

/// 0 to 1 over s in [0, 1] with zero first and second derivatives at both ends: s^3 (10 - 15 s + 6 s^2).
inline double smooth_step(double s) {
  s = std::clamp(s, 0.0, 1.0);
  return s * s * s * (10 + s * (-15 + 6 * s));
}

/// Largest slope of smooth_step, at s = 1/2.
inline constexpr double kSteepest = 15.0 / 8;

}  // namespace interply::coordinator
