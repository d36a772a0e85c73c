/// What a sheet shows: fields of a frame, nodal thickness, summary, digest.
#include <algorithm>

#include "solver_metal/j2_law.hpp"
#include "solver_metal/metal_layer.hpp"

namespace interply::metal {

namespace {

/// A field of one value per element, filled by f(element).
template <typename F>
observe::Field make_field(const char* name, const char* unit, const char* description, Eigen::Index n, const F& f) {
  observe::Field field{.name = name, .unit = unit, .description = description, .values = {}};
  field.values.resize(static_cast<std::size_t>(n));
  for (Eigen::Index e = 0; e < n; ++e) field.values[e] = f(e);
  return field;
}

}  // namespace

mechanics::Scalars MetalLayer::compute_nodal_thickness() const {
  const mechanics::ShellGeometry& shell = shell_.geometry();
  mechanics::Scalars volume = mechanics::Scalars::Zero(mass_.size()), area = volume;  // of the elements of each node
  for (Eigen::Index e = 0; e < n_elements(); ++e)
    for (int k = 0; k < 3; ++k) {
      volume(shell.nodes(k, e)) += shell.area(e) * thickness_(e);
      area(shell.nodes(k, e)) += shell.area(e);
    }
  return (area > 0).select(volume / area, thickness0_);
}

std::vector<observe::Field> MetalLayer::compute_fields(const mechanics::NodalVectors&) const {
  const Eigen::Index n = n_elements();
  const int points = rule_.size(), low = (points - 1) / 2, high = points / 2;  // equal for an odd number of points
  const auto midsurface = [&](Eigen::Index e) { return 0.5 * (load_stress(low, e) + load_stress(high, e)); };
  const auto mean_strain = [&](Eigen::Index e) {
    double sum = 0;
    for (int i = 0; i < points; ++i) sum += rule_.weight[i] * plastic_strain_(i, e);
    return sum;
  };
  const auto stretches = [&](Eigen::Index e) {
    return compute_principal(Symmetric2{metric_(0, e), metric_(1, e), metric_(2, e)});
  };
  std::vector<observe::Field> fields{
      make_field("thickness", "mm", "current thickness", n, [&](auto e) { return thickness_(e); }),
      make_field("sigma_11", "MPa", "Cauchy stress along x (rolling, where it counts) at the midsurface, polar frame",
                 n, [&](auto e) { return midsurface(e).m11; }),
      make_field("sigma_22", "MPa", "Cauchy stress across sigma_11 at the midsurface, polar frame", n,
                 [&](auto e) { return midsurface(e).m22; }),
      make_field("sigma_12", "MPa", "Cauchy shear stress at the midsurface, polar frame", n,
                 [&](auto e) { return midsurface(e).m12; }),
      make_field("von_mises", "MPa", "von Mises stress at the midsurface", n,
                 [&](auto e) { return compute_von_mises(midsurface(e)); }),
      make_field("stretch_1", "-", "larger principal stretch of the midsurface", n,
                 [&](auto e) { return std::sqrt(stretches(e).first); }),
      make_field("stretch_2", "-", "smaller principal stretch of the midsurface", n,
                 [&](auto e) { return std::sqrt(stretches(e).second); }),
  };
  if (own_) {
    own_->add_fields(fields);
    return fields;
  }
  fields.push_back(make_field("plastic_strain", "-", "equivalent plastic strain, largest through the thickness", n,
                              [&](auto e) { return plastic_strain_.col(e).maxCoeff(); }));
  fields.push_back(
      make_field("plastic_strain_mean", "-", "equivalent plastic strain, mean through the thickness", n, mean_strain));
  return fields;
}

/// Sources: THEORY.md 3.
std::vector<solve::TrustLimit> MetalLayer::trust_limits() const {
  return {{"thinning", "%", 25, "deep-drawing steel necks and fails there"}};
}

Eigen::ArrayXXd MetalLayer::compute_trust_quantities(const mechanics::NodalVectors&) const {
  return 100 * (1 - thickness_.transpose() / thickness0_);
}

std::vector<exchange::SummaryItem> MetalLayer::summarise(const mechanics::NodalVectors&) const {
  double von_mises = 0;
  for (Eigen::Index e = 0; e < n_elements(); ++e)
    for (int i = 0; i < rule_.size(); ++i) von_mises = std::max(von_mises, compute_von_mises(load_stress(i, e)));
  std::vector<exchange::SummaryItem> items;
  if (!own_) items.push_back({"plastic strain up to", "-", plastic_strain_.maxCoeff()});
  items.push_back({"thinning up to", "%", 100 * (1 - thickness_.minCoeff() / thickness0_)});
  items.push_back({"von Mises stress up to", "MPa", von_mises});
  if (own_ && own_->largest_stress_33() > 0)
    items.push_back({"not plane stress: stress 33 up to", "MPa", own_->largest_stress_33()});
  return items;
}

void MetalLayer::add_state_to(mechanics::Digest& digest) const {
  digest.add(stress_);
  digest.add(plastic_strain_);
  digest.add(thickness_);
  digest.add(shell_.edges().angle());
  digest.add(shell_.edges().rate());
  if (own_) own_->add_state_to(digest);
}

}  // namespace interply::metal
