/// `interply point`: a law at one material point along a prescribed deformation, for calibration.
#pragma once

#include <filesystem>
#include <iosfwd>

namespace interply::launch {

/// Reads a law (the `law` block of a scene's layer) and a path, writes the response as CSV with 17 significant digits.
///
/// Woven law: columns F11,F12,F21,F22 in any order, the in-plane deformation gradient in the fibre frame (a0 = e1,
/// b0 = e2); writes F11,F12,F21,F22,I4,I8,gamma_rad,W_MPa,S11_MPa,S22_MPa,S12_MPa,min_eig_hessian_MPa.
/// J2 law: column strain, the true strain along a bar whose sides are free; writes
/// strain,stress_MPa,plastic_strain,width_strain,thickness_strain.
///
/// A law or a row that cannot be used is refused on `err` with file name and line number, and nothing is written.
/// @return 0, or 2 if refused
int run_point(const std::filesystem::path& law, const std::filesystem::path& path_csv, std::ostream& out,
              std::ostream& err);

}  // namespace interply::launch
