#include "contact/cells.hpp"

namespace interply::contact {

namespace {

using Reach = Cells::Reach;

/// Cell `i`, one of the `of_kind` of a reach, is within reach of the blocks that have its nodes.
template <std::size_t kCorners>
void enter(std::vector<Reach>& reaches, Span Reach::*of_kind, Eigen::Index i, const std::array<int, kCorners>& nodes) {
  const auto [low, high] = std::minmax_element(nodes.begin(), nodes.end());
  for (const int node : nodes) {
    Reach& reach = reaches[static_cast<std::size_t>(node / kBlockSize)];
    reach.*of_kind = join(reach.*of_kind, {i, i + 1});
    reach.nodes = join(reach.nodes, {*low, *high + 1});
  }
}

}  // namespace

Reach Cells::find_reach(const Span& nodes) const {
  Reach all;
  if (nodes.is_empty()) return all;
  for (Eigen::Index b = nodes.first / kBlockSize; b <= (nodes.last - 1) / kBlockSize; ++b) {
    const Reach& one = reaches[static_cast<std::size_t>(b)];
    all = {join(all.nodes, one.nodes), join(all.pairs, one.pairs), join(all.singles, one.singles)};
  }
  return all;
}

Cells pair_triangles(const mechanics::TriangleMesh& mesh) {
  Cells cells;
  std::vector<bool> taken(static_cast<std::size_t>(mesh.n_elements()));
  for (Eigen::Index e = 0; e < mesh.n_elements(); ++e) {
    if (taken[static_cast<std::size_t>(e)]) continue;
    const auto corner = [&](int k) { return mesh.triangles(k % 3, e); };
    int partner = -1, opposite = 0;  // corner of e opposite the side to the partner
    for (int k = 0; k < 3; ++k) {
      const int next = mesh.neighbours(k, e);
      if (next <= e || taken[static_cast<std::size_t>(next)] || (partner >= 0 && partner < next)) continue;
      partner = next;
      opposite = k;
    }
    if (partner < 0) {
      cells.singles.push_back({corner(0), corner(1), corner(2)});
      continue;
    }
    taken[static_cast<std::size_t>(partner)] = true;
    const int a = corner(opposite + 2), b = corner(opposite), c = corner(opposite + 1);
    int d = -1;
    for (int k = 0; k < 3; ++k)
      if (mesh.neighbours(k, partner) == e) d = mesh.triangles(k, partner);
    cells.pairs.push_back({a, b, c, d});
  }
  cells.reaches.resize(static_cast<std::size_t>(count_blocks(mesh.n_nodes())));
  for (std::size_t i = 0; i < cells.pairs.size(); ++i)
    enter(cells.reaches, &Reach::pairs, static_cast<Eigen::Index>(i), cells.pairs[i]);
  for (std::size_t i = 0; i < cells.singles.size(); ++i)
    enter(cells.reaches, &Reach::singles, static_cast<Eigen::Index>(i), cells.singles[i]);
  return cells;
}

}  // namespace interply::contact
