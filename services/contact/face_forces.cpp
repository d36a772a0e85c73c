#include "contact/face_forces.hpp"

#include "contact/fours.hpp"

namespace interply::contact {

using Eigen::Index;

FaceForces::FaceForces(const LayerGeometry& layer, std::vector<Quad>& records)
    : layer_(layer), force_(NodalVectors::Zero(3, layer.n_nodes())), records_(records) {
  records_.resize(std::max(records_.size(), static_cast<std::size_t>(2 * layer.n_nodes())));
}

double FaceForces::finish(const Span& acting) {
  const Cells::Reach reach = layer_.find_reach(acting);
  const Span acts = join(acting, reach.nodes), all = join(acts, acted_);
  const auto clear = [&](Index begin, Index end) { std::fill(records() + 2 * begin, records() + 2 * end, Quad{}); };
  if (acting.is_empty()) {
    clear(all.first, all.last);
  } else {
    clear(all.first, acting.first);
    clear(acting.last, all.last);
  }
  acted_ = acts;
  layer_.add_forces_of_pulls(records(), reach);

  const Node* const nodes = layer_.nodes();
  const Quad* const records = records_.data();
  double* const force[3] = {&force_(0, 0), &force_(1, 0), &force_(2, 0)};
  Four work[3] = {};
  for_each_four(all.first, all.last, [&](Index i, int count) {
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
  const Four sum = work[0] + work[1] + work[2];
  return 0.5 * (sum[0] + sum[1] + sum[2] + sum[3]);
}

}  // namespace interply::contact
