#include "solver_metal/metal_layer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "solver_metal/hardening.hpp"

namespace interply::metal {

namespace {

constexpr double kSmallestAreaRatio = 0.05, kLargestAreaRatio = 20;

const MetalKernels& choose_kernels() {
  return simd::choose([](auto target) -> auto& { return get_metal_kernels<decltype(target)>(); });
}

Symmetric2 load(const Rows& rows, Eigen::Index first, Eigen::Index e) {
  return {rows(first, e), rows(first + 1, e), rows(first + 2, e)};
}

template <class Array>
void store(Array& rows, Eigen::Index first, Eigen::Index e, const Symmetric2& a) {
  rows(first, e) = a.m11;
  rows(first + 1, e) = a.m22;
  rows(first + 2, e) = a.m12;
}

/// An own law has elastic constants of its own; the defaults here are then not used.
scene::J2Law find_j2(const scene::Layer& layer) {
  const auto* law = std::get_if<scene::J2Law>(&layer.law);
  return law ? *law : scene::J2Law{};
}

/// Of the reference frame from x, rad: the rolling direction, where there is one.
double find_frame_angle(const scene::Layer& layer) {
  const auto* law = std::get_if<scene::J2Law>(&layer.law);
  return law && !law->hill48 ? 0 : layer.orientation_deg * std::numbers::pi / 180;
}

std::unique_ptr<VumatSection> make_own(const scene::Layer& layer, const ThicknessRule& rule,
                                       const mechanics::TriangleMesh& mesh) {
  if (!std::holds_alternative<scene::VumatLaw>(layer.law)) return nullptr;
  return std::make_unique<VumatSection>(layer, rule, mesh);
}

/// D over (k11, k22, 2 k12) of the elastic sheet, N mm.
Eigen::Matrix3d compute_plate_stiffness(const LawConstants& law, const VumatSection* own, const ThicknessRule& rule,
                                        double t) {
  if (own) return 0.25 * rule.second_moment() * t * t * t * own->initial_tangent();
  Eigen::Matrix3d d;
  d << 1, law.poisson, 0, law.poisson, 1, 0, 0, 0, 0.5 * (1 - law.poisson);
  return 0.25 * rule.second_moment() * t * t * t * law.young / (1 - law.poisson * law.poisson) * d;
}

}  // namespace

MetalLayer::MetalLayer(const scene::Layer& layer, double density, const mechanics::TriangleMesh& mesh)
    : name_(layer.name),
      law_(find_j2(layer)),
      rule_(make_lobatto_rule(layer.integration_points)),
      thickness0_(layer.thickness),
      own_(make_own(layer, rule_, mesh)),
      mass_(mechanics::compute_lumped_mass(mesh, layer.thickness, density)),
      shell_(mesh, find_frame_angle(layer),
             {compute_plate_stiffness(law_, own_.get(), rule_, layer.thickness), layer.thickness * density},
             layer.threads, own_ ? solve::Keep::All : solve::Keep::Rings),
      bending_frequency2_(mechanics::compute_bending_frequencies2(
          shell_.geometry(), compute_plate_stiffness(law_, own_.get(), rule_, layer.thickness), mass_,
          shell_.edges().inertia())),
      nodal_stiffness_(mesh.n_nodes()),
      blocks_(shell_.n_blocks()),
      kernels_(choose_kernels()) {
  const Eigen::Index n = n_elements(), points = rule_.size();
  metric_ = Rows::Zero(3, n);
  metric_.topRows(2).setOnes();
  curvature_ = Rows::Zero(3, n);
  stress_ = Rows::Zero(3 * points, n);
  plastic_strain_ = Rows::Zero(points, n);
  const YieldStress<double> initial = compute_yield_stress(law_.hardening, 0);
  yield_stress_ = Rows::Constant(points, n, initial.stress);
  yield_slope_ = Rows::Constant(points, n, initial.slope);
  thickness_ = mechanics::Scalars::Constant(n, layer.thickness);
  rows_ = make_rows();
}

SheetRows MetalLayer::make_rows() {
  SheetRows rows;
  for (int c = 0; c < 3; ++c) {
    rows.metric[c] = &metric_(c, 0);
    rows.curvature[c] = &curvature_(c, 0);
  }
  rows.thickness = thickness_.data();
  rows.stress = stress_.data();
  rows.plastic_strain = plastic_strain_.data();
  rows.yield_stress = yield_stress_.data();
  rows.yield_slope = yield_slope_.data();
  rows.xi = rule_.point.data();
  rows.weight = rule_.weight.data();
  rows.n_points = rule_.size();
  rows.n = n_elements();
  return rows;
}

void MetalLayer::compute_internal_forces(const mechanics::NodalVectors& position, const solve::Instant& now,
                                         mechanics::NodalVectors& force) {
  if (own_) own_->begin(position, now);
  const double* const x[3] = {&position(0, 0), &position(1, 0), &position(2, 0)};
  const auto facets = [&](Eigen::Index, Eigen::Index begin, Eigen::Index end) -> Eigen::Index {
    return kernels_.compute_facets(shell_.rows(), x, kSmallestAreaRatio, kLargestAreaRatio, begin, end);
  };
  const double* const phi = shell_.edges().angle().data();
  const auto advance = [&](Eigen::Index block, Eigen::Index begin, Eigen::Index end) {
    blocks_[static_cast<std::size_t>(block)] =
        own_ ? advance_own(begin, end) : kernels_.advance(shell_.rows(), rows_, law_, phi, begin, end);
  };
  const solve::Shell::Result result = shell_.compute_forces(now.dt, facets, advance, force);
  if (result.bad >= 0) report(result.bad, position, now.time);
  for (const SheetAdvance& block : blocks_) {
    if (block.bad >= 0) report(block.bad, position, now.time);
    internal_energy_ += block.work;
  }
  internal_energy_ += result.energy;
}

SheetAdvance MetalLayer::advance_own(Eigen::Index begin, Eigen::Index end) {
  const mechanics::ShellGeometry& geometry = shell_.geometry();
  mechanics::ShellPasses& passes = shell_.passes();
  SheetAdvance result;
  std::array<OwnStep, solve::kVumatBlock> steps;
  for (Eigen::Index first = begin; first < end; first += solve::kVumatBlock) {
    const Eigen::Index last = std::min<Eigen::Index>(end, first + solve::kVumatBlock);
    for (Eigen::Index e = first; e < last; ++e) {
      const mechanics::SurfaceGradient g = passes.facet(e);
      const auto k = mechanics::compute_curvature(geometry, passes, shell_.edges().angle(), e);
      OwnStep& step = steps[static_cast<std::size_t>(e - first)];
      step.now = {{g.f1.squaredNorm(), g.f2.squaredNorm(), g.f1.dot(g.f2)}, {k.k11, k.k22, k.k12}, g.area_ratio};
      const Symmetric2 metric = load(metric_, 0, e);
      const ElementShape before{metric, load(curvature_, 0, e), std::sqrt(metric.determinant())};
      step.area_ratio_before = before.area_ratio;
      step.strain = compute_strain_increment(before, step.now, thickness_(e));
      own_->set_increment(e, step.now, step.strain, thickness_(e));
    }
    own_->advance(first, last);
    for (Eigen::Index e = first; e < last; ++e) {
      const auto k = mechanics::compute_curvature(geometry, passes, shell_.edges().angle(), e);
      const Resultants r = take_own_element(e, steps[static_cast<std::size_t>(e - first)], result.work);
      store(passes.membrane, 0, e, geometry.area(e) * r.force);
      mechanics::store_moments(geometry, k, r.moment.m11, r.moment.m22, r.moment.m12, e, passes);
      if (!(thickness_(e) > 0 && std::isfinite(thickness_(e)))) {
        result.bad = e;
        return result;
      }
    }
  }
  return result;
}

Symmetric2 MetalLayer::load_stress(int i, Eigen::Index e) const { return load(stress_, 3 * i, e); }

Resultants MetalLayer::take_own_element(Eigen::Index e, const OwnStep& step, double& work) {
  const double thickness_before = thickness_(e);
  Symmetric2 mean{}, moment{};
  double thickness_strain = 0, stress_work = 0;
  for (int i = 0; i < rule_.size(); ++i) {
    const double w = rule_.weight[i], xi = rule_.point[i];
    const Symmetric2 stress_before = load(stress_, 3 * i, e);
    Symmetric2 stress{};
    thickness_strain += w * own_->take(e, i, stress);
    stress_work += w * 0.5 * contract(stress_before + stress, step.strain.membrane + xi * step.strain.bending);
    mean = mean + w * stress;
    moment = moment + (w * xi) * stress;
    store(stress_, 3 * i, e, stress);
  }
  if (own_->is_still()) return compute_resultants(step.now, thickness_before, mean, moment);
  const double thickness = thickness_before * std::exp(thickness_strain);
  work += 0.5 * shell_.geometry().area(e) *
          (step.area_ratio_before * thickness_before + step.now.area_ratio * thickness) * stress_work;
  thickness_(e) = thickness;
  store(metric_, 0, e, step.now.metric);
  store(curvature_, 0, e, step.now.curvature);
  return compute_resultants(step.now, thickness, mean, moment);
}

double MetalLayer::compute_stable_increment(const mechanics::NodalVectors&) {
  nodal_stiffness_.setZero();
  kernels_.add_nodal_stiffness(shell_.rows(), rows_, nodal_stiffness_.data());
  nodal_stiffness_ /= mass_;
  IncrementRows rows{nodal_stiffness_.data(), bending_frequency2_.data(), law_.young, law_.poisson, 1, thickness0_};
  if (own_) {
    rows.young = own_->compute_modulus_bound();
    rows.poisson = 0;
    rows.stiffening = std::max(1.0, rows.young / own_->initial_modulus_bound());
  }
  std::vector<double> highest(shell_.n_blocks());
  shell_.for_each_block([&](Eigen::Index block, Eigen::Index begin, Eigen::Index end) {
    highest[static_cast<std::size_t>(block)] = kernels_.bound_frequency2(shell_.rows(), rows_, rows, begin, end);
  });
  return 2 / std::sqrt(*std::max_element(highest.begin(), highest.end()));  // (T1)
}

void MetalLayer::report(Eigen::Index e, const mechanics::NodalVectors& position, double time) const {
  const double area_ratio = mechanics::compute_surface_gradient(shell_.geometry(), position, e).area_ratio;
  mechanics::Vector3 centre = mechanics::Vector3::Zero();
  for (int k = 0; k < 3; ++k) centre += mechanics::at(position, shell_.geometry().nodes(k, e)) / 3;
  std::ostringstream text;
  text << "layer " << name_ << ", element " << e << " at (" << centre.x() << ", " << centre.y() << ", " << centre.z()
       << ") mm, t = " << time << " s: ";
  int lost = -1;  // corner without a finite position
  for (int k = 2; k >= 0; --k)
    if (!mechanics::at(position, shell_.geometry().nodes(k, e)).allFinite()) lost = shell_.geometry().nodes(k, e);
  if (lost >= 0) {
    const mechanics::Vector3 x = mechanics::at(position, lost);
    text << "node " << lost << " is at (" << x.x() << ", " << x.y() << ", " << x.z()
         << "), the motion is no longer finite; lower time.safety or time.vote_every, and look at the last frames";
  } else if (area_ratio <= kSmallestAreaRatio || area_ratio > kLargestAreaRatio) {
    text << "area ratio " << area_ratio << " is not in [" << kSmallestAreaRatio << ", " << kLargestAreaRatio
         << "], the element is crushed or torn open; refine blank.mesh_size, lower time.safety, or check friction and "
            "blank-holder pressure";
  } else if (own_) {
    text << "the vumat returned a stress or a thickness strain that is not finite; check law.vumat.parameters of this "
            "layer, or lower time.safety";
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
