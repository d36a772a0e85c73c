#include "solver_fabric/fabric_layer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace interply::fabric {

using mechanics::Vector3;

namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

/// False also for NaN, whose comparisons all fail.
bool is_usable(const FabricPoint& p, double area_ratio) {
  return p.cosine > kFoldedCosine && area_ratio > kFoldedAreaRatio;
}

/// D over (k11, k22, 2 k12), N mm.
Eigen::Matrix3d make_bending_stiffness(const scene::Layer& layer) {
  return Eigen::Vector3d(layer.bending.warp, layer.bending.weft, layer.twist).asDiagonal();
}

}  // namespace

FabricLayer::FabricLayer(const scene::Layer& layer, double mass_scaling, const mechanics::TriangleMesh& mesh)
    : name_(layer.name),
      thickness_(layer.thickness),
      density_(layer.density * mass_scaling),
      bending_{layer.bending.warp, layer.bending.weft, layer.twist},
      kernels_(choose_fabric_kernels()),
      shell_(mesh, layer.orientation_deg / kDegrees, {make_bending_stiffness(layer), thickness_ * density_},
             layer.threads, std::holds_alternative<scene::VumatLaw>(layer.law) ? solve::Keep::All : solve::Keep::Rings),
      stretch_results_(shell_.n_blocks()),
      block_energy_(shell_.n_blocks()) {
  bending_frequency2_ = mechanics::compute_bending_frequencies2(
                            shell_.geometry(), make_bending_stiffness(layer),
                            mechanics::compute_lumped_mass(mesh, thickness_, density_), shell_.edges().inertia())
                            .maxCoeff();
  if (const auto* woven = std::get_if<scene::WovenLaw>(&layer.law))
    law_ = make_membrane_law(*woven);
  else
    own_ = std::make_unique<VumatMembrane>(layer, shell_.geometry(), mesh.reference);
}

void FabricLayer::compute_internal_forces(const mechanics::NodalVectors& position, const solve::Instant& now,
                                          mechanics::NodalVectors& force) {
  if (own_) stretch_own_law(position, now);
  const double* const x[3] = {&position(0, 0), &position(1, 0), &position(2, 0)};
  const auto stretch = [&](Eigen::Index block, Eigen::Index begin, Eigen::Index end) -> Eigen::Index {
    MembraneResult& result = stretch_results_[static_cast<std::size_t>(block)];
    if (!own_) result = kernels_.stretch(shell_.rows(), x, *law_, thickness_, begin, end);
    return result.failed;
  };
  const double* const phi = shell_.edges().angle().data();
  const auto bend = [&](Eigen::Index block, Eigen::Index begin, Eigen::Index end) {
    block_energy_[static_cast<std::size_t>(block)] = kernels_.bend(shell_.rows(), phi, bending_, begin, end);
  };
  const solve::Shell::Result result = shell_.compute_forces(now.dt, stretch, bend, force);
  if (result.bad >= 0) throw_divergence(result.bad, position, now.time);
  energy_ = own_ ? own_energy_ : 0;
  for (std::size_t block = 0; block < block_energy_.size(); ++block)
    energy_ += stretch_results_[block].energy + block_energy_[block];
  edge_energy_ += result.energy;
}

void FabricLayer::stretch_own_law(const mechanics::NodalVectors& x, const solve::Instant& now) {
  mechanics::ShellPasses& passes = shell_.passes();
  for (Eigen::Index e = 0; e < shell_.n_elements(); ++e) {
    const mechanics::SurfaceGradient g = mechanics::compute_surface_gradient(shell_.geometry(), x, e);
    passes.store_facet(e, g);
    if (!is_usable(compute_deformation(g.f1, g.f2, g.area_ratio), g.area_ratio)) throw_divergence(e, x, now.time);
  }
  if (const Eigen::Index e = own_->advance(passes.f1, passes.f2, x, now); e >= 0) throw_divergence(e, x, now.time);
  own_energy_ = 0;
  for (Eigen::Index e = 0; e < shell_.n_elements(); ++e) {
    if (!std::isfinite(own_->energy(e))) throw_divergence(e, x, now.time);
    const double volume = shell_.geometry().area(e) * thickness_;
    const Vector3 S = own_->stress(e);
    passes.membrane.col(e) << volume * S(0), volume * S(1), volume * S(2);
    own_energy_ += volume * own_->energy(e);
  }
}

void FabricLayer::throw_divergence(Eigen::Index e, const mechanics::NodalVectors& x, double time) const {
  Vector3 centre = Vector3::Zero();
  for (int k = 0; k < 3; ++k) centre += mechanics::at(x, shell_.geometry().nodes(k, e)) / 3;
  const mechanics::SurfaceGradient g = mechanics::compute_surface_gradient(shell_.geometry(), x, e);
  const FabricPoint p = compute_deformation(g.f1, g.f2, g.area_ratio);
  std::string quantity, cure;
  if (is_usable(p, g.area_ratio) && own_) {
    quantity = own_->describe_response(e);
    cure = "check law.vumat.parameters of this ply, or lower time.safety";
  } else if (is_usable(p, g.area_ratio)) {
    quantity = fmt::format("the strain energy is {} MPa at the fibre stretches {:.4g} and {:.4g}",
                           evaluate_element(x, e).W, p.la, p.lb);
    cure = "lower the biaxial coupling c or set a strain_cap for this ply's law";
  } else if (!std::isfinite(g.area_ratio) || !std::isfinite(p.cosine)) {
    quantity = fmt::format("the area ratio is {}", g.area_ratio);
    cure = "lower time.safety, or check this ply's density, law and mesh";
  } else if (!(p.cosine > kFoldedCosine)) {
    quantity = fmt::format("the shear angle is {:.4g} deg, past the 85 deg at which an element counts as folded",
                           p.gamma * kDegrees);
    cure = "refine the mesh, stiffen the shear law (s) or shorten the stroke";
  } else {
    quantity = fmt::format("the area ratio is {:.4g}, not above the {} at which an element counts as folded",
                           g.area_ratio, kFoldedAreaRatio);
    cure = "refine the mesh, raise the compressive stiffness d or shorten the stroke";
  }
  throw mechanics::Divergence(
      fmt::format("layer {}, element {} centred at ({:.4g}, {:.4g}, {:.4g}) mm, t = {:.6g} s: {}; {}", name_, e,
                  centre.x(), centre.y(), centre.z(), time, quantity, cure));
}

FabricPoint FabricLayer::evaluate_element(const mechanics::NodalVectors& x, Eigen::Index e) const {
  const mechanics::SurfaceGradient g = mechanics::compute_surface_gradient(shell_.geometry(), x, e);
  if (!own_) return evaluate_point(*law_, g.f1, g.f2, g.area_ratio);
  FabricPoint p = compute_deformation(g.f1, g.f2, g.area_ratio);
  const Vector3 S = own_->stress(e);
  p.W = own_->energy(e);
  p.S11 = S(0);
  p.S22 = S(1);
  p.S12 = S(2);
  return p;
}

double FabricLayer::compute_stable_increment(const mechanics::NodalVectors& position) {
  if (own_) return 2 / std::sqrt(3 / density_ * own_->compute_eigenvalue_bound() + bending_frequency2_);
  const double* const x[3] = {&position(0, 0), &position(1, 0), &position(2, 0)};
  std::vector<double> largest(shell_.n_blocks());
  shell_.for_each_block([&](Eigen::Index block, Eigen::Index begin, Eigen::Index end) {
    largest[static_cast<std::size_t>(block)] = kernels_.bound(shell_.rows(), x, *law_, begin, end);
  });
  const double membrane = 3 / density_ * *std::max_element(largest.begin(), largest.end());  // (T1)
  return 2 / std::sqrt(membrane + bending_frequency2_);
}

mechanics::Scalars FabricLayer::compute_nodal_thickness() const {
  return own_ ? thickness_ * own_->compute_nodal_thickness_stretch() : mechanics::Scalars();
}

std::vector<observe::Field> FabricLayer::compute_fields(const mechanics::NodalVectors& position) const {
  enum { Shear, Warp, Weft, S11, S22, S12, Energy, BeyondCap, Eigenvalue };
  const auto n = static_cast<std::size_t>(shell_.n_elements());
  std::vector<observe::Field> fields;
  const auto add = [&](const char* name, const char* unit, const char* description) {
    fields.push_back({name, unit, description, /*nodal=*/false, std::vector<double>(n), /*components=*/1});
  };
  add("shear_angle", "rad", "90 degrees less the angle from warp to weft: positive where they close in on each other");
  add("stretch_warp", "-", "stretch of the warp, la");
  add("stretch_weft", "-", "stretch of the weft, lb");
  add("S11", "MPa", "second Piola-Kirchhoff stress, warp");
  add("S22", "MPa", "second Piola-Kirchhoff stress, weft");
  add("S12", "MPa", "second Piola-Kirchhoff stress, shear");
  add("energy_density", "MPa", "membrane strain energy per reference volume");
  if (!own_) {
    add("beyond_cap", "-", "1 where a transverse strain is beyond strain_cap, else 0");
    add("smallest_hessian_eigenvalue", "MPa",
        "of the strain energy in (la, lb, gamma); negative: the law is not convex");
  }
  for (std::size_t i = 0; i < n; ++i) {
    const FabricPoint p = evaluate_element(position, static_cast<Eigen::Index>(i));
    fields[Shear].values[i] = p.gamma;
    fields[Warp].values[i] = p.la;
    fields[Weft].values[i] = p.lb;
    fields[S11].values[i] = p.S11;
    fields[S22].values[i] = p.S22;
    fields[S12].values[i] = p.S12;
    fields[Energy].values[i] = p.W;
    if (own_) continue;
    fields[BeyondCap].values[i] = is_beyond_cap(*law_, p.la, p.lb) ? 1 : 0;
    fields[Eigenvalue].values[i] = p.smallest_eigenvalue;
  }
  if (own_) own_->add_fields(fields);
  add_fibre_directions(position, fields);
  return fields;
}

void FabricLayer::add_fibre_directions(const mechanics::NodalVectors& position,
                                       std::vector<observe::Field>& fields) const {
  mechanics::NodalVectors warp(3, shell_.n_elements()), weft = warp;
  for (Eigen::Index e = 0; e < shell_.n_elements(); ++e) {
    const mechanics::SurfaceGradient g = mechanics::compute_surface_gradient(shell_.geometry(), position, e);
    warp.col(e) = g.f1.normalized().array();
    weft.col(e) = g.f2.normalized().array();
  }
  const auto add = [&](const char* name, const char* description, const mechanics::NodalVectors& a) {
    fields.push_back({name, "-", description, /*nodal=*/false, {a.data(), a.data() + a.size()}, /*components=*/3});
  };
  add("warp", "unit vector along the warp in the deformed midsurface", warp);
  add("weft", "unit vector along the weft in the deformed midsurface; at rest +90 degrees from the warp, seen from +z",
      weft);
}

/// Sources: THEORY.md 3.
std::vector<solve::TrustLimit> FabricLayer::trust_limits() const {
  std::vector<solve::TrustLimit> limits{
      {"fibre strain", "%", 4.8, "glass filaments break there"},
      {"fibre compression", "%", 0.6, "fibres kink in bands one element wide"},
      {"shear angle", "deg", 60, "yarns have locked and wrinkle; no shear test reaches it"}};
  if (!own_) limits.push_back({"loss of convexity", "MPa", 0, "the law softens and its answer is not unique"});
  return limits;
}

Eigen::ArrayXXd FabricLayer::compute_trust_quantities(const mechanics::NodalVectors& position) const {
  Eigen::ArrayXXd quantities(own_ ? 3 : 4, shell_.n_elements());
  for (Eigen::Index e = 0; e < shell_.n_elements(); ++e) {
    const FabricPoint p = evaluate_element(position, e);
    quantities(0, e) = 100 * (std::max(p.la, p.lb) - 1);
    quantities(1, e) = 100 * (1 - std::min(p.la, p.lb));
    quantities(2, e) = std::abs(p.gamma) * kDegrees;
    if (!own_) quantities(3, e) = -p.smallest_eigenvalue;
  }
  return quantities;
}

std::vector<exchange::SummaryItem> FabricLayer::summarise(const mechanics::NodalVectors& position) const {
  double shear = 0, longest = 0, shortest = std::numeric_limits<double>::infinity(), beyond_cap = 0, indefinite = 0;
  for (Eigen::Index e = 0; e < shell_.n_elements(); ++e) {
    const FabricPoint p = evaluate_element(position, e);
    shear = std::max(shear, std::abs(p.gamma));
    longest = std::max({longest, p.la, p.lb});
    shortest = std::min({shortest, p.la, p.lb});
    if (own_) continue;
    beyond_cap += is_beyond_cap(*law_, p.la, p.lb);
    indefinite += p.smallest_eigenvalue < 0;
  }
  std::vector<exchange::SummaryItem> items{{"shear angle up to", "deg", shear * kDegrees},
                                           {"fibre strain up to", "%", 100 * (longest - 1)},
                                           {"down to", "%", 100 * (shortest - 1)}};
  if (own_ && own_->largest_stress_33() > 0)
    items.push_back({"not plane stress: stress 33 up to", "MPa", own_->largest_stress_33()});
  if (own_) return items;
  const double n = static_cast<double>(shell_.n_elements());
  items.push_back({"elements beyond cap", "%", 100 * beyond_cap / n});
  items.push_back({"not convex", "%", 100 * indefinite / n});
  return items;
}

void FabricLayer::add_state_to(mechanics::Digest& digest) const {
  digest.add(shell_.edges().angle());
  digest.add(shell_.edges().rate());
  if (own_) own_->add_state_to(digest);
}

std::unique_ptr<solve::LayerMechanics> make_fabric_layer(const scene::Scene& scene, int layer,
                                                         const mechanics::TriangleMesh& mesh) {
  return std::make_unique<FabricLayer>(scene.layers.at(static_cast<std::size_t>(layer)), scene.time.mass_scaling, mesh);
}

}  // namespace interply::fabric
