#include "solver_metal/metal_layer.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "solver_metal/stable_increment.hpp"

namespace interply::metal {

namespace {

constexpr double kSmallestAreaRatio = 0.05, kLargestAreaRatio = 20;

Symmetric2 load(const Rows& rows, Eigen::Index first, Eigen::Index e) {
  return {rows(first, e), rows(first + 1, e), rows(first + 2, e)};
}

void store(Rows& rows, Eigen::Index first, Eigen::Index e, const Symmetric2& a) {
  rows(first, e) = a.m11;
  rows(first + 1, e) = a.m22;
  rows(first + 2, e) = a.m12;
}

}  // namespace

MetalLayer::MetalLayer(const scene::Layer& layer, double density, const mechanics::TriangleMesh& mesh)
    : name_(layer.name),
      law_(std::get<scene::J2Law>(layer.law)),
      rule_(make_lobatto_rule(layer.integration_points)),
      thickness0_(layer.thickness),
      patches_(mechanics::make_shell_patches(mesh, 0.0)),
      mass_(mechanics::compute_lumped_mass(mesh, layer.thickness, density)),
      workers_(layer.threads) {
  const Eigen::Index n = n_elements(), points = rule_.size();
  bending_compliance_ = compute_bending_compliance(patches_, mass_, law_.poisson);
  nodal_stiffness_.resize(mesh.n_nodes());
  metric_ = Rows::Zero(3, n);
  metric_.topRows(2).setOnes();
  curvature_ = Rows::Zero(3, n);
  stress_ = Rows::Zero(3 * points, n);
  plastic_strain_ = Rows::Zero(points, n);
  const YieldStress initial = compute_yield_stress(law_.hardening, 0);
  yield_stress_ = Rows::Constant(points, n, initial.stress);
  yield_slope_ = Rows::Constant(points, n, initial.slope);
  thickness_ = mechanics::Scalars::Constant(n, layer.thickness);
  slot_force_ = mechanics::NodalVectors::Zero(3, 6 * n);
  block_work_.resize(static_cast<std::size_t>(solve::count_blocks(n)));
  block_bad_.resize(block_work_.size());
}

void MetalLayer::compute_internal_forces(const mechanics::NodalVectors& position, double time,
                                         mechanics::NodalVectors& force) {
  workers_.for_each_block(n_elements(), [&](Eigen::Index block, Eigen::Index begin, Eigen::Index end) {
    block_bad_[block] = {};
    block_work_[block] = advance_elements(position, begin, end, block_bad_[block]);
  });
  for (const BadElement& bad : block_bad_)
    if (bad.element >= 0) report(bad, position, time);
  for (const double work : block_work_) internal_energy_ += work;
  force.resize(3, position.cols());
  workers_.for_each_block(position.cols(), [&](Eigen::Index, Eigen::Index begin, Eigen::Index end) {
    mechanics::gather_forces(patches_.gather, slot_force_, begin, end, force);
  });
}

double MetalLayer::advance_elements(const mechanics::NodalVectors& position, Eigen::Index begin, Eigen::Index end,
                                    BadElement& bad) {
  double work = 0;
  for (Eigen::Index e = begin; e < end; ++e) {
    const auto g = mechanics::compute_surface_gradient(patches_, position, e);
    if (!(g.area_ratio > kSmallestAreaRatio && g.area_ratio <= kLargestAreaRatio)) {
      bad = {e, g.area_ratio};
      return work;
    }
    const auto k = mechanics::compute_curvature(patches_, position, e, g);
    const ElementShape now{
        {g.f1.squaredNorm(), g.f2.squaredNorm(), g.f1.dot(g.f2)}, {k.k11, k.k22, k.k12}, g.area_ratio};
    add_element_forces(e, g, k, advance_element(e, now, work));
    if (!(thickness_(e) > 0 && std::isfinite(thickness_(e)))) {
      bad = {e, g.area_ratio};
      return work;
    }
  }
  return work;
}

J2Point MetalLayer::load_point(int i, Eigen::Index e) const {
  return {load(stress_, 3 * i, e), plastic_strain_(i, e), {yield_stress_(i, e), yield_slope_(i, e)}};
}

void MetalLayer::store_point(int i, Eigen::Index e, const J2Point& point) {
  store(stress_, 3 * i, e, point.stress);
  plastic_strain_(i, e) = point.plastic_strain;
  yield_stress_(i, e) = point.yield.stress;
  yield_slope_(i, e) = point.yield.slope;
}

Resultants MetalLayer::advance_element(Eigen::Index e, const ElementShape& now, double& work) {
  const Symmetric2 metric = load(metric_, 0, e);
  const ElementShape before{metric, load(curvature_, 0, e), std::sqrt(metric.determinant())};
  const double thickness_before = thickness_(e);
  const StrainIncrement de = compute_strain_increment(before, now, thickness_before);

  Symmetric2 mean, moment;
  double thickness_strain = 0, stress_work = 0;
  for (int i = 0; i < rule_.size(); ++i) {
    const double w = rule_.weight[i], xi = rule_.point[i];
    const Symmetric2 strain = de.membrane + xi * de.bending;
    J2Point point = load_point(i, e);
    const Symmetric2 stress_before = point.stress;
    thickness_strain += w * update_point(law_, strain, point);
    stress_work += w * 0.5 * contract(stress_before + point.stress, strain);
    mean = mean + w * point.stress;
    moment = moment + (w * xi) * point.stress;
    store_point(i, e, point);
  }
  const double thickness = thickness_before * std::exp(thickness_strain);
  const double mean_volume =
      0.5 * patches_.area(e) * (before.area_ratio * thickness_before + now.area_ratio * thickness);
  work += mean_volume * stress_work;
  thickness_(e) = thickness;
  store(metric_, 0, e, now.metric);
  store(curvature_, 0, e, now.curvature);
  return compute_resultants(now, thickness, mean, moment);
}

void MetalLayer::add_element_forces(Eigen::Index e, const mechanics::SurfaceGradient& g,
                                    const mechanics::Curvature& curvature, const Resultants& r) {
  double along_t3[6];
  mechanics::compute_bending_forces(patches_, e, curvature, r.moment.m11, r.moment.m22, r.moment.m12, along_t3);
  const double area = patches_.area(e);
  const mechanics::Vector3 p1 = area * (r.force.m11 * g.f1 + r.force.m12 * g.f2);
  const mechanics::Vector3 p2 = area * (r.force.m12 * g.f1 + r.force.m22 * g.f2);
  const Eigen::Index n = n_elements();
  for (int k = 0; k < 3; ++k) {
    const mechanics::Vector3 own =
        patches_.gradient(2 * k, e) * p1 + patches_.gradient(2 * k + 1, e) * p2 + along_t3[k] * g.t3;
    const double far = along_t3[3 + k];
    for (int c = 0; c < 3; ++c) slot_force_(c, k * n + e) = own(c);
    slot_force_(0, (3 + k) * n + e) = far * g.t3.x();
    slot_force_(1, (3 + k) * n + e) = far * g.t3.y() * patches_.mirror_y(k, e);
    slot_force_(2, (3 + k) * n + e) = far * g.t3.z();
  }
}

MetalLayer::CornerGradients MetalLayer::compute_corner_gradients(Eigen::Index e) const {
  const Symmetric2 metric = load(metric_, 0, e);
  const double j = std::sqrt(metric.determinant());
  const Symmetric2 u = compute_inverse_stretch(metric, j);
  CornerGradients corner;
  corner.volume = patches_.area(e) * j * thickness_(e);
  for (int k = 0; k < 3; ++k) {
    const double b1 = patches_.gradient(2 * k, e), b2 = patches_.gradient(2 * k + 1, e);
    const double g1 = u.m11 * b1 + u.m12 * b2, g2 = u.m12 * b1 + u.m22 * b2;
    corner.product[k] = {g1 * g1, g2 * g2, g1 * g2};
  }
  return corner;
}

double MetalLayer::compute_stable_increment() {
  nodal_stiffness_.setZero();  // q of (T2)
  for (Eigen::Index e = 0; e < n_elements(); ++e) {
    const CornerGradients corner = compute_corner_gradients(e);
    for (int k = 0; k < 3; ++k) nodal_stiffness_(patches_.nodes(k, e)) += corner.volume * corner.product[k].trace();
  }
  const double bending_modulus = 0.25 * rule_.second_moment() * law_.young / (1 - law_.poisson * law_.poisson);
  double highest = 0;
  for (Eigen::Index e = 0; e < n_elements(); ++e) {
    const CornerGradients corner = compute_corner_gradients(e);
    Symmetric2 gram;
    for (int k = 0; k < 3; ++k) {
      const int node = patches_.nodes(k, e);
      const double weight = nodal_stiffness_(node) / (mass_(node) * corner.product[k].trace());
      gram = gram + weight * corner.product[k];
    }
    double von_mises = 0;
    for (int i = 0; i < rule_.size(); ++i) von_mises = std::max(von_mises, compute_von_mises(load(stress_, 3 * i, e)));
    const double stress = 1.1547005383792517 * von_mises;  // no principal plane stress exceeds 2/sqrt(3) s_eq
    const double membrane = bound_membrane_frequency2(gram, law_.young, law_.poisson, stress);
    // physical curvature is U^-1 kappa U^-1
    const Symmetric2 metric = load(metric_, 0, e);
    const double t = thickness_(e), least = compute_principal(metric).second;
    const double bending =
        std::sqrt(metric.determinant()) * t * t * t * bending_modulus / (least * least) * bending_compliance_(e);
    highest = std::max(highest, membrane + bending);  // (T1)
  }
  return 2 / std::sqrt(highest);
}

void MetalLayer::report(const BadElement& bad, const mechanics::NodalVectors& position, double time) const {
  const Eigen::Index e = bad.element;
  mechanics::Vector3 centre = mechanics::Vector3::Zero();
  for (int k = 0; k < 3; ++k) centre += mechanics::at(position, patches_.nodes(k, e)) / 3;
  std::ostringstream text;
  text << "layer " << name_ << ", element " << e << " at (" << centre.x() << ", " << centre.y() << ", " << centre.z()
       << ") mm, t = " << time << " s: ";
  int lost = -1;  // node of the patch without a finite position
  for (int slot = 5; slot >= 0; --slot)
    if (!mechanics::at(position, patches_.nodes(slot, e)).allFinite()) lost = patches_.nodes(slot, e);
  if (lost >= 0) {
    const mechanics::Vector3 x = mechanics::at(position, lost);
    text << "node " << lost << " is at (" << x.x() << ", " << x.y() << ", " << x.z()
         << "), the motion is no longer finite; lower time.safety or time.vote_every, and look at the last frames";
  } else if (bad.area_ratio <= kSmallestAreaRatio || bad.area_ratio > kLargestAreaRatio) {
    text << "area ratio " << bad.area_ratio << " is not in [" << kSmallestAreaRatio << ", " << kLargestAreaRatio
         << "], the element is crushed or torn open; refine blank.mesh_size, lower time.safety, or check friction and "
            "blank-holder pressure";
  } else {
    text << "thickness is " << thickness_(e)
         << " mm, the strain increment was too large; lower time.safety or time.vote_every, or check the hardening";
  }
  throw mechanics::Divergence(text.str());
}

std::unique_ptr<solve::LayerMechanics> make_metal_layer(const scene::Scene& scene, int layer,
                                                        const mechanics::TriangleMesh& mesh) {
  const scene::Layer& own = scene.layers.at(static_cast<std::size_t>(layer));
  return std::make_unique<MetalLayer>(own, own.density * scene.time.mass_scaling, mesh);
}

}  // namespace interply::metal
