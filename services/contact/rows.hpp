/// The arrays of contact as its kernels see them (kernels.hpp).
#pragma once

#include "contact/kernels.hpp"
#include "contact/layer_geometry.hpp"
#include "contact/points.hpp"

namespace interply::contact {

inline ConstRows get_rows(const NodalVectors& a) { return {&a(0, 0), &a(1, 0), &a(2, 0)}; }
inline Rows get_rows(NodalVectors& a) { return {&a(0, 0), &a(1, 0), &a(2, 0)}; }

inline LayerRows get_rows(const LayerGeometry& g) {
  return {get_rows(g.position), get_rows(g.increment), get_rows(g.normal), get_rows(g.turn), g.half_thickness.data()};
}

inline PointRows get_rows(Points& p) {
  return {.area = p.area.data(),
          .gap = p.gap.data(),
          .weight = p.weight.data(),
          .pressure = p.pressure.data(),
          .damping = p.damping.data(),
          .slip = p.slip.data(),
          .height = p.height.data(),
          .stick = get_rows(p.stick),
          .traction = get_rows(p.traction),
          .state = p.state.data()};
}

}  // namespace interply::contact
