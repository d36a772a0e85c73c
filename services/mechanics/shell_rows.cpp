#include "mechanics/shell_rows.hpp"

#include "mechanics/edge_shell.hpp"

namespace interply::mechanics {

ShellRows::ShellRows(const ShellGeometry& s, ShellPasses& passes)
    : area(s.area.data()),
      image_facet(passes.image_facet.data()),
      first_side(passes.first_side.data()),
      second_side(passes.second_side.data()),
      gather_start(s.gather.start.data()),
      gather_entry(passes.gather_entry.data()),
      image_plane{s.image_plane.data(), s.image_plane.data() + s.image_plane.cols()},
      facets{passes.rings.facets.size, passes.rings.facets.stride, 0},
      moments{passes.rings.moments.size, passes.rings.moments.stride, 0},
      corners{passes.rings.corners.size, passes.rings.corners.stride, 0},
      area_ratio(passes.area_ratio.data()),
      slope_moment(passes.slope_moment.data()),
      hinge_factor(passes.hinge_factor.data()),
      height_force(passes.height_force.data()) {
  for (int k = 0; k < 3; ++k) {
    node[k] = &s.nodes(k, 0);
    edge[k] = &s.edge(k, 0);
    side[k] = &s.side(k, 0);
    hinged[k] = &s.hinged(k, 0);
    across[k] = &passes.across(k, 0);
    opposite[k] = &passes.opposite(k, 0);
    f1[k] = &passes.f1(k, 0);
    f2[k] = &passes.f2(k, 0);
    t3[k] = &passes.t3(k, 0);
    membrane[k] = &passes.membrane(k, 0);
    corner_force[k] = &passes.corner_force(k, 0);
  }
  for (int i = 0; i < 6; ++i) gradient[i] = &s.gradient(i, 0);
}

void ShellRows::turn_to(std::ptrdiff_t begin) {
  for (View* ring : {&facets, &moments, &corners}) ring->shift = begin % ring->size - begin;
}

}  // namespace interply::mechanics
