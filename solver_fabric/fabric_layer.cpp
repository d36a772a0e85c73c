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

/// Strain energy per reference volume (MPa) and stress of an element.
struct Response {
  double W = 0;
  MembraneStress stress;
};

template <typename Law>
Response respond(const Law& law, const FibreState& s, Eigen::Index) {
  const Potential w = law.evaluate(s.la, s.lb, s.gamma);
  return {w.W, compute_membrane_stress(w, s)};
}

Response respond(const VumatMembrane& own, const FibreState&, Eigen::Index e) { return {own.energy(e), own.stress(e)}; }

/// D over (k11, k22, 2 k12), N mm.
Eigen::Matrix3d make_bending_stiffness(const scene::Layer& layer) {
  return Eigen::Vector3d(layer.bending.warp, layer.bending.weft, layer.twist).asDiagonal();
}

}  // namespace

FabricLayer::FabricLayer(const scene::Layer& layer, double mass_scaling, const mechanics::TriangleMesh& mesh)
    : name_(layer.name),
      thickness_(layer.thickness),
      density_(layer.density * mass_scaling),
      bending_(layer.bending),
      twist_(layer.twist),
      shell_(mechanics::make_shell_geometry(mesh, layer.orientation_deg / kDegrees)),
      la_(mechanics::Scalars::Ones(mesh.n_elements())),
      lb_(mechanics::Scalars::Ones(mesh.n_elements())),
      gamma_(mechanics::Scalars::Zero(mesh.n_elements())),
      edges_(shell_, {make_bending_stiffness(layer), thickness_ * density_}),
      passes_(shell_),
      slot_force_(mechanics::NodalVectors::Zero(3, 3 * mesh.n_elements())),
      block_energy_(static_cast<std::size_t>(solve::count_blocks(mesh.n_elements())), 0.0),
      block_edge_energy_(static_cast<std::size_t>(solve::count_blocks(shell_.n_edges())), 0.0),
      failed_(block_energy_.size(), -1),
      bending_frequency2_(mechanics::compute_bending_frequencies2(
                              shell_, make_bending_stiffness(layer),
                              mechanics::compute_lumped_mass(mesh, thickness_, density_), edges_.inertia())
                              .maxCoeff()),
      workers_(layer.threads) {
  if (const auto* woven = std::get_if<scene::WovenLaw>(&layer.law))
    law_ = make_membrane_law(*woven);
  else
    own_ = std::make_unique<VumatMembrane>(layer, shell_, mesh.reference);
}

void FabricLayer::compute_internal_forces(const mechanics::NodalVectors& position, const solve::Instant& now,
                                          mechanics::NodalVectors& force) {
  const Eigen::Index n = shell_.n_elements(), n_edges = shell_.n_edges();
  workers_.for_each_block(
      n_edges, [&](Eigen::Index, Eigen::Index begin, Eigen::Index end) { edges_.advance(now.dt, begin, end); });
  edges_.finish(now.dt);
  if (own_) advance_own_law(position, now);
  workers_.for_each_block(n, [&](Eigen::Index block, Eigen::Index begin, Eigen::Index end) {
    const auto compute = [&](const auto& law) { return compute_membrane(law, position, begin, end, failed_[block]); };
    block_energy_[block] = own_ ? compute(*own_) : std::visit(compute, *law_);
  });
  for (const Eigen::Index e : failed_)
    if (e >= 0) throw_divergence(e, position, now.time);
  workers_.for_each_block(n, [&](Eigen::Index block, Eigen::Index begin, Eigen::Index end) {
    block_energy_[block] += compute_bending(begin, end);
  });
  workers_.for_each_block(n, [&](Eigen::Index, Eigen::Index begin, Eigen::Index end) {
    for (Eigen::Index e = begin; e < end; ++e) mechanics::add_bending_forces(shell_, passes_, e, slot_force_);
  });
  workers_.for_each_block(n_edges, [&](Eigen::Index block, Eigen::Index begin, Eigen::Index end) {
    block_edge_energy_[block] = edges_.update_torques(shell_, passes_, now.dt, begin, end);
  });

  force.resize(3, position.cols());
  workers_.for_each_block(position.cols(), [&](Eigen::Index, Eigen::Index begin, Eigen::Index end) {
    mechanics::gather_forces(shell_.gather, slot_force_, begin, end, force);
  });
  energy_ = 0;
  for (const double w : block_energy_) energy_ += w;
  for (const double w : block_edge_energy_) edge_energy_ += w;
}

void FabricLayer::advance_own_law(const mechanics::NodalVectors& x, const solve::Instant& now) {
  for (Eigen::Index e = 0; e < shell_.n_elements(); ++e) {
    const mechanics::SurfaceGradient g = mechanics::compute_surface_gradient(shell_, x, e);
    if (!is_usable(compute_fibre_state(g.f1, g.f2, g.area_ratio), g.area_ratio)) throw_divergence(e, x, now.time);
    passes_.store_facet(e, g);
  }
  if (const Eigen::Index e = own_->advance(passes_.f1, passes_.f2, x, now); e >= 0) throw_divergence(e, x, now.time);
}

template <typename Law>
double FabricLayer::compute_membrane(const Law& law, const mechanics::NodalVectors& x, Eigen::Index begin,
                                     Eigen::Index end, Eigen::Index& failed) {
  const Eigen::Index n = shell_.n_elements();
  double energy = 0;
  failed = -1;
  for (Eigen::Index e = begin; e < end; ++e) {
    const mechanics::SurfaceGradient g = mechanics::compute_surface_gradient(shell_, x, e);
    passes_.store_facet(e, g);
    const FibreState s = compute_fibre_state(g.f1, g.f2, g.area_ratio);
    la_(e) = s.la;
    lb_(e) = s.lb;
    gamma_(e) = s.gamma;
    const Response w = respond(law, s, e);
    if (!is_usable(s, g.area_ratio) || !std::isfinite(w.W)) {
      if (failed < 0) failed = e;
      continue;
    }
    Vector3 corner[3];
    compute_membrane_forces(shell_, e, g, w.stress, shell_.area(e) * thickness_, corner);
    for (int k = 0; k < 3; ++k)
      for (int c = 0; c < 3; ++c) slot_force_(c, k * n + e) = corner[k](c);
    energy += shell_.area(e) * thickness_ * w.W;
  }
  return energy;
}

double FabricLayer::compute_bending(Eigen::Index begin, Eigen::Index end) {
  double energy = 0;
  for (Eigen::Index e = begin; e < end; ++e) {
    const mechanics::Curvature k = mechanics::compute_curvature(shell_, passes_, edges_.angle(), e);
    const double m11 = bending_.warp * k.k11, m22 = bending_.weft * k.k22, m12 = twist_ * 2 * k.k12;
    mechanics::store_moments(shell_, k, m11, m22, m12, e, passes_);
    energy += shell_.area(e) * (m11 * k.k11 + m22 * k.k22 + 2 * m12 * k.k12) / 2;
  }
  return energy;
}

void FabricLayer::throw_divergence(Eigen::Index e, const mechanics::NodalVectors& x, double time) const {
  Vector3 centre = Vector3::Zero();
  for (int k = 0; k < 3; ++k) centre += mechanics::at(x, shell_.nodes(k, e)) / 3;
  const mechanics::SurfaceGradient g = mechanics::compute_surface_gradient(shell_, x, e);
  const FibreState s = compute_fibre_state(g.f1, g.f2, g.area_ratio);
  std::string quantity, cure;
  if (is_usable(s, g.area_ratio) && own_) {
    quantity = own_->describe_response(e);
    cure = "check law.vumat.parameters of this ply, or lower time.safety";
  } else if (is_usable(s, g.area_ratio)) {
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
  return std::visit([&](const auto& law) { return law.evaluate(la_(e), lb_(e), gamma_(e)); }, *law_);
}

double FabricLayer::compute_stable_increment() {
  if (own_) return 2 / std::sqrt(3 / density_ * own_->compute_eigenvalue_bound() + bending_frequency2_);
  const scene::Pair floor = std::visit([](const auto& law) { return law.stiffness_floor(); }, *law_);
  std::vector<double> largest(block_energy_.size(), 0.0);
  workers_.for_each_block(shell_.n_elements(), [&](Eigen::Index block, Eigen::Index begin, Eigen::Index end) {
    double& bound = largest[static_cast<std::size_t>(block)];
    for (Eigen::Index e = begin; e < end; ++e)
      bound = std::max(bound, compute_membrane_eigenvalue_bound(potential(e), fibre_state(e),
                                                                compute_gradient_products(shell_, e), floor));
  });
  const double membrane = 3 / density_ * *std::max_element(largest.begin(), largest.end());  // (T1)
  return 2 / std::sqrt(membrane + bending_frequency2_);
}

mechanics::Scalars FabricLayer::compute_nodal_thickness() const {
  return own_ ? thickness_ * own_->compute_nodal_thickness_stretch() : mechanics::Scalars();
}

std::vector<observe::Field> FabricLayer::compute_fields() const {
  enum { Shear, Warp, Weft, S11, S22, S12, Energy, BeyondCap, Eigenvalue };
  const auto n = static_cast<std::size_t>(shell_.n_elements());
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
  for (std::size_t i = 0; i < n; ++i) {
    const auto e = static_cast<Eigen::Index>(i);
    const auto compute = [&](const auto& law) { return respond(law, fibre_state(e), e); };
    const Response w = own_ ? compute(*own_) : std::visit(compute, *law_);
    fields[Shear].values[i] = gamma_(e);
    fields[Warp].values[i] = la_(e);
    fields[Weft].values[i] = lb_(e);
    fields[S11].values[i] = w.stress.S11;
    fields[S22].values[i] = w.stress.S22;
    fields[S12].values[i] = w.stress.S12;
    fields[Energy].values[i] = w.W;
  }
  if (own_) {
    own_->add_fields(fields);
    return fields;
  }
  add("beyond_cap", "1", "1 where a transverse strain is beyond strain_cap, else 0");
  add("smallest_hessian_eigenvalue", "MPa", "of the strain energy in (la, lb, gamma); negative: the law is not convex");
  for (std::size_t i = 0; i < n; ++i) {
    const auto e = static_cast<Eigen::Index>(i);
    fields[BeyondCap].values[i] =
        std::visit([&](const auto& law) { return law.is_beyond_cap(la_(e), lb_(e)) ? 1.0 : 0.0; }, *law_);
    fields[Eigenvalue].values[i] = compute_smallest_eigenvalue(potential(e));
  }
  return fields;
}

std::vector<exchange::SummaryItem> FabricLayer::summarise() const {
  std::vector<exchange::SummaryItem> items{
      {"shear angle up to", "deg", gamma_.abs().maxCoeff() * kDegrees},
      {"fibre strain up to", "%", 100 * (std::max(la_.maxCoeff(), lb_.maxCoeff()) - 1)},
      {"down to", "%", 100 * (std::min(la_.minCoeff(), lb_.minCoeff()) - 1)}};
  if (own_) return items;
  const double n = static_cast<double>(shell_.n_elements());
  double beyond_cap = 0, indefinite = 0;
  for (Eigen::Index e = 0; e < shell_.n_elements(); ++e) {
    beyond_cap += std::visit([&](const auto& law) { return law.is_beyond_cap(la_(e), lb_(e)); }, *law_);
    indefinite += compute_smallest_eigenvalue(potential(e)) < 0;
  }
  items.push_back({"elements beyond cap", "%", 100 * beyond_cap / n});
  items.push_back({"not convex", "%", 100 * indefinite / n});
  return items;
}

void FabricLayer::add_state_to(mechanics::Digest& digest) const {
  digest.add(edges_.angle());
  digest.add(edges_.rate());
  if (own_) own_->add_state_to(digest);
}

std::unique_ptr<solve::LayerMechanics> make_fabric_layer(const scene::Scene& scene, int layer,
                                                         const mechanics::TriangleMesh& mesh) {
  return std::make_unique<FabricLayer>(scene.layers.at(static_cast<std::size_t>(layer)), scene.time.mass_scaling, mesh);
}

}  // namespace interply::fabric
