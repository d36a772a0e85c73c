/// `interply point`: a law at one material point along a prescribed deformation, for calibration.
#pragma once

#include <filesystem>
#include <iosfwd>
#include <stdexcept>
#include <string>

#include "scene/scene.hpp"

namespace interply::launch {

/// A path that cannot be used; what() is one sentence with file and line.
class PathError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The response of a law along a path, both as CSV text (columns: run_point); `origin` stands for the path's file name.
/// @throws PathError
std::string follow_path(const scene::Law& law, const std::string& csv, const std::string& origin);

/// Reads a law (the `law` block of a scene's layer) and a path, writes the response as CSV with 17 significant digits.
///
/// Woven law: columns F11,F12,F21,F22 in any order, the in-plane deformation gradient in the fibre frame (a0 = e1,
/// b0 = e2); writes F11,F12,F21,F22,I4,I8,gamma_rad,W_MPa,S11_MPa,S22_MPa,S12_MPa,min_eig_hessian_MPa.
/// J2 law: column strain, the true strain along a bar whose sides are free; writes
/// strain,stress_MPa,plastic_strain,width_strain,thickness_strain.
/// vumat: F11,F12,F21,F22 as well, one second per row from F = 1; writes them with F33, the Cauchy stress in the polar
/// frame and the state variables.
///
/// A law or a row that cannot be used is refused on `err` with file name and line number, and nothing is written.
/// @return 0, or 2 if refused
int run_point(const std::filesystem::path& law, const std::filesystem::path& path_csv, std::ostream& out,
              std::ostream& err);

}  // namespace interply::launch
