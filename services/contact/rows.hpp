/// The arrays of contact as its kernels see them (kernels.hpp).
#pragma once

#include "contact/kernels.hpp"
#include "contact/points.hpp"

namespace interply::contact {

inline ConstRows get_rows(const NodalVectors& a) { return {&a(0, 0), &a(1, 0), &a(2, 0)}; }
inline Rows get_rows(NodalVectors& a) { return {&a(0, 0), &a(1, 0), &a(2, 0)}; }

inline PointRows get_rows(Points& p) {
  return {.area = p.area.data(),
          .gap = p.gap.data(),
          .weight = p.weight.data(),
          .pressure = p.pressure.data(),
          .slip = p.slip.data(),
          .friction_work = p.friction_work.data(),
          .height = p.height.data(),
          .stick = get_rows(p.stick),
          .state = p.state.data()};
}

}  // namespace interply::contact
