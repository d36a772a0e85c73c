#include "contact/face_forces.hpp"

#include "contact/fours.hpp"

namespace interply::contact {

using Eigen::Index;

FaceForces::FaceForces(const LayerGeometry& layer, std::vector<Quad>& records)
    : layer_(layer), force_(NodalVectors::Zero(3, layer.n_nodes())), records_(records) {
  records_.resize(std::max(records_.size(), static_cast<std::size_t>(2 * layer.n_nodes())));
}

double FaceForces::finish() {
  layer_.add_forces_of_pulls(records_.data());
  is_zero_ = false;
  const Node* const nodes = layer_.nodes();
  const Quad* const records = records_.data();
  double* const force[3] = {&force_(0, 0), &force_(1, 0), &force_(2, 0)};
  Four work[3] = {};
  for_each_four(force_.cols(), [&](Index i, int count) {
    const Vectors now = gather(
        i, count, [&](Index k) -> auto& { return records[2 * k]; });
    const Vectors by = gather(
        i, count, [&](Index k) -> auto& { return nodes[k].increment; });
    const Four next[3] = {now.x, now.y, now.z}, increment[3] = {by.x, by.y, by.z};
    for (int d = 0; d < 3; ++d) {
      Four part = (load_row(force[d], i, count) + next[d]) * increment[d];
      for (int l = count; l < 4; ++l) part[l] = 0;
      work[d] += part;
      store_row(force[d], i, count, next[d]);
    }
  });
  const Four all = work[0] + work[1] + work[2];
  return 0.5 * (all[0] + all[1] + all[2] + all[3]);
}

double FaceForces::finish_without_forces() {
  if (is_zero_) return 0;
  double work = 0;
  for (Index i = 0; i < force_.cols(); ++i) work += 0.5 * mechanics::at(force_, i).dot(layer_.increment(i));
  force_.setZero();
  is_zero_ = true;
  return work;
}

}  // namespace interply::contact
