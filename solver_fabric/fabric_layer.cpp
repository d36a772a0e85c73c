#include "solver_fabric/fabric_layer.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "solver_fabric/stable_increment.hpp"

namespace interply::fabric {

namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

/// False also for NaN, whose comparisons all fail.
bool is_usable(const FibreState& s, double area_ratio) {
  return s.cos_gamma > kFoldedCosine && area_ratio > kFoldedAreaRatio;
}

}  // namespace

FabricLayer::FabricLayer(const scene::Layer& layer, double mass_scaling, const mechanics::TriangleMesh& mesh)
    : name_(layer.name),
      thickness_(layer.thickness),
      density_(layer.density * mass_scaling),
      bending_(layer.bending),
      twist_(layer.twist),
      law_(make_membrane_law(std::get<scene::WovenLaw>(layer.law))),
      patches_(mechanics::make_shell_patches(mesh, layer.orientation_deg / kDegrees)),
      bending_frequency_bound_(
          compute_bending_frequency_bound(patches_, mesh, mechanics::compute_lumped_mass(mesh, thickness_, density_),
                                          std::max({bending_.warp, bending_.weft, 2 * twist_}))),
      la_(mechanics::Scalars::Ones(mesh.n_elements())),
      lb_(mechanics::Scalars::Ones(mesh.n_elements())),
      gamma_(mechanics::Scalars::Zero(mesh.n_elements())),
      slot_force_(mechanics::NodalVectors::Zero(3, 6 * mesh.n_elements())),
      block_energy_(static_cast<std::size_t>(solve::count_blocks(mesh.n_elements())), 0.0),
      failed_(block_energy_.size(), -1),
      workers_(layer.threads) {}

void FabricLayer::compute_internal_forces(const mechanics::NodalVectors& position, double time,
                                          mechanics::NodalVectors& force) {
  workers_.for_each_block(patches_.n_elements(), [&](Eigen::Index block, Eigen::Index begin, Eigen::Index end) {
    std::visit([&](const auto& law) { compute_block(law, position, block, begin, end); }, law_);
  });
  for (const Eigen::Index e : failed_)
    if (e >= 0) throw_divergence(e, position, time);

  force.resize(3, position.cols());
  workers_.for_each_block(position.cols(), [&](Eigen::Index, Eigen::Index begin, Eigen::Index end) {
    mechanics::gather_forces(patches_.gather, slot_force_, begin, end, force);
  });
  energy_ = 0;
  for (const double w : block_energy_) energy_ += w;
}

template <typename Law>
void FabricLayer::compute_block(const Law& law, const mechanics::NodalVectors& x, Eigen::Index block,
                                Eigen::Index begin, Eigen::Index end) {
  const Eigen::Index n = patches_.n_elements();
  double energy = 0;
  Eigen::Index failed = -1;
  for (Eigen::Index e = begin; e < end; ++e) {
    const mechanics::SurfaceGradient g = mechanics::compute_surface_gradient(patches_, x, e);
    const FibreState s = compute_fibre_state(g.f1, g.f2, g.area_ratio);
    la_(e) = s.la;
    lb_(e) = s.lb;
    gamma_(e) = s.gamma;
    const Potential w = law.evaluate(s.la, s.lb, s.gamma);
    if (!is_usable(s, g.area_ratio) || !std::isfinite(w.W)) {
      if (failed < 0) failed = e;
      continue;
    }

    Vector3 corner[3];
    compute_membrane_forces(patches_, e, g, compute_membrane_stress(w, s), patches_.area(e) * thickness_, corner);
    const mechanics::Curvature k = mechanics::compute_curvature(patches_, x, e, g);
    const double m11 = bending_.warp * k.k11, m22 = bending_.weft * k.k22, m12 = twist_ * 2 * k.k12;
    double along_t3[6];
    mechanics::compute_bending_forces(patches_, e, k, m11, m22, m12, along_t3);

    for (int slot = 0; slot < 3; ++slot) {
      const Vector3 own = corner[slot] + along_t3[slot] * g.t3;
      Vector3 far = along_t3[3 + slot] * g.t3;
      far.y() *= patches_.mirror_y(slot, e);
      for (int c = 0; c < 3; ++c) {
        slot_force_(c, slot * n + e) = own(c);
        slot_force_(c, (3 + slot) * n + e) = far(c);
      }
    }
    energy += patches_.area(e) * (thickness_ * w.W + (m11 * k.k11 + m22 * k.k22 + 2 * m12 * k.k12) / 2);
  }
  block_energy_[static_cast<std::size_t>(block)] = energy;
  failed_[static_cast<std::size_t>(block)] = failed;
}

void FabricLayer::throw_divergence(Eigen::Index e, const mechanics::NodalVectors& x, double time) const {
  Vector3 centre = Vector3::Zero();
  for (int k = 0; k < 3; ++k) centre += mechanics::at(x, patches_.nodes(k, e)) / 3;
  const mechanics::SurfaceGradient g = mechanics::compute_surface_gradient(patches_, x, e);
  const FibreState s = compute_fibre_state(g.f1, g.f2, g.area_ratio);
  std::string quantity, cure;
  if (is_usable(s, g.area_ratio)) {
    quantity =
        fmt::format("the strain energy is {} MPa at the fibre stretches {:.4g} and {:.4g}", potential(e).W, s.la, s.lb);
    cure = "lower the biaxial coupling c or set a strain_cap for this ply's law";
  } else if (!std::isfinite(g.area_ratio) || !std::isfinite(s.cos_gamma)) {
    quantity = fmt::format("the area ratio is {}", g.area_ratio);
    cure = "lower time.safety, or check this ply's density, law and mesh";
  } else if (!(s.cos_gamma > kFoldedCosine)) {
    quantity = fmt::format("the shear angle is {:.4g} deg, past the 85 deg at which an element counts as folded",
                           s.gamma * kDegrees);
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

FibreState FabricLayer::fibre_state(Eigen::Index e) const {
  return {la_(e) * la_(e), lb_(e) * lb_(e), la_(e), lb_(e), gamma_(e), std::cos(gamma_(e)), std::sin(gamma_(e))};
}

Potential FabricLayer::potential(Eigen::Index e) const {
  return std::visit([&](const auto& law) { return law.evaluate(la_(e), lb_(e), gamma_(e)); }, law_);
}

double FabricLayer::compute_stable_increment() {
  const scene::Pair floor = std::visit([](const auto& law) { return law.stiffness_floor(); }, law_);
  std::vector<double> largest(block_energy_.size(), 0.0);
  workers_.for_each_block(patches_.n_elements(), [&](Eigen::Index block, Eigen::Index begin, Eigen::Index end) {
    double& bound = largest[static_cast<std::size_t>(block)];
    for (Eigen::Index e = begin; e < end; ++e)
      bound = std::max(bound, compute_membrane_eigenvalue_bound(potential(e), fibre_state(e),
                                                                compute_gradient_products(patches_, e), floor));
  });
  const double membrane = 3 / density_ * *std::max_element(largest.begin(), largest.end());  // (T1)
  return 2 / std::sqrt(membrane + bending_frequency_bound_);
}

std::vector<observe::Field> FabricLayer::compute_fields() const {
  enum { Shear, Warp, Weft, S11, S22, S12, Energy, BeyondCap, Eigenvalue };
  const auto n = static_cast<std::size_t>(patches_.n_elements());
  std::vector<observe::Field> fields;
  const auto add = [&](const char* name, const char* unit, const char* description) {
    fields.push_back({name, unit, description, /*nodal=*/false, std::vector<double>(n), /*components=*/1});
  };
  add("shear_angle", "rad", "angle by which warp and weft have left 90 degrees");
  add("stretch_warp", "1", "stretch of the warp, la");
  add("stretch_weft", "1", "stretch of the weft, lb");
  add("S11", "MPa", "second Piola-Kirchhoff stress, warp");
  add("S22", "MPa", "second Piola-Kirchhoff stress, weft");
  add("S12", "MPa", "second Piola-Kirchhoff stress, shear");
  add("energy_density", "MPa", "membrane strain energy per reference volume");
  add("beyond_cap", "1", "1 where a transverse strain is beyond strain_cap, else 0");
  add("smallest_hessian_eigenvalue", "MPa", "of the strain energy in (la, lb, gamma); negative: the law is not convex");
  for (std::size_t i = 0; i < n; ++i) {
    const auto e = static_cast<Eigen::Index>(i);
    const Potential w = potential(e);
    const MembraneStress s = compute_membrane_stress(w, fibre_state(e));
    fields[Shear].values[i] = gamma_(e);
    fields[Warp].values[i] = la_(e);
    fields[Weft].values[i] = lb_(e);
    fields[S11].values[i] = s.S11;
    fields[S22].values[i] = s.S22;
    fields[S12].values[i] = s.S12;
    fields[Energy].values[i] = w.W;
    fields[BeyondCap].values[i] =
        std::visit([&](const auto& law) { return law.is_beyond_cap(la_(e), lb_(e)) ? 1.0 : 0.0; }, law_);
    fields[Eigenvalue].values[i] = compute_smallest_eigenvalue(w);
  }
  return fields;
}

std::vector<exchange::SummaryItem> FabricLayer::summarise() const {
  const double n = static_cast<double>(patches_.n_elements());
  double beyond_cap = 0, indefinite = 0;
  for (Eigen::Index e = 0; e < patches_.n_elements(); ++e) {
    beyond_cap += std::visit([&](const auto& law) { return law.is_beyond_cap(la_(e), lb_(e)); }, law_);
    indefinite += compute_smallest_eigenvalue(potential(e)) < 0;
  }
  return {{"shear angle up to", "deg", gamma_.abs().maxCoeff() * kDegrees},
          {"fibre strain up to", "%", 100 * (std::max(la_.maxCoeff(), lb_.maxCoeff()) - 1)},
          {"down to", "%", 100 * (std::min(la_.minCoeff(), lb_.minCoeff()) - 1)},
          {"elements beyond cap", "%", 100 * beyond_cap / n},
          {"not convex", "%", 100 * indefinite / n}};
}

std::unique_ptr<solve::LayerMechanics> make_fabric_layer(const scene::Scene& scene, int layer,
                                                         const mechanics::TriangleMesh& mesh) {
  return std::make_unique<FabricLayer>(scene.layers.at(static_cast<std::size_t>(layer)), scene.time.mass_scaling, mesh);
}

}  // namespace interply::fabric
