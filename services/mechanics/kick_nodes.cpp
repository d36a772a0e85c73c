#include "mechanics/kick_nodes.hpp"

#include "simd/pack.hpp"

namespace interply::mechanics {

using Real = simd::Pack;

template <>
KickSums kick_nodes<simd::Target>(const KickRows& nodes, double span, std::ptrdiff_t n) {
  const auto& [m, f, g, v] = nodes;
  simd::Sum<Real> kinetic(0), contact_before(0), contact_after(0), internal_before(0), internal_after(0);
  simd::for_each_pack<Real>(0, n, [&](const auto& lanes) {
    const simd::Vec3<Real> contact = lanes.load(f[0], f[1], f[2]), internal = lanes.load(g[0], g[1], g[2]);
    const simd::Vec3<Real> old = lanes.load(v[0], v[1], v[2]);
    const Real mass = lanes.load(m);
    const simd::Vec3<Real> now = old + (Real(span) / mass) * (contact - internal);
    lanes.store(v[0], v[1], v[2], now);
    kinetic.add(lanes, mass * dot(old, now));
    contact_before.add(lanes, dot(contact, old));
    contact_after.add(lanes, dot(contact, now));
    internal_before.add(lanes, dot(internal, old));
    internal_after.add(lanes, dot(internal, now));
  });
  return {0.5 * kinetic.total(),
          {contact_before.total(), internal_before.total()},
          {contact_after.total(), internal_after.total()}};
}

}  // namespace interply::mechanics
