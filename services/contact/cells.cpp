#include "contact/cells.hpp"

namespace interply::contact {

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
  return cells;
}

}  // namespace interply::contact
