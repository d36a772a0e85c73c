/// The kick of central_difference.hpp in one pass over the nodes, compiled for each target of simd/target.hpp.
#pragma once

#include <cstddef>

#include "simd/target.hpp"

namespace interply::mechanics {

/// Rows over the nodes.
struct KickRows {
  const double* mass;         ///< t
  const double* contact[3];   ///< N
  const double* internal[3];  ///< N, pulls the nodes
  double* velocity[3];        ///< v(n - 1/2) -> v(n + 1/2), mm/s
};

/// Power of a force, mJ/s.
struct Power {
  double contact = 0, internal = 0;
};

/// Sums over the nodes.
struct KickSums {
  double kinetic = 0;   ///< 1/2 m v(n - 1/2) . v(n + 1/2), mJ
  Power before, after;  ///< of the forces at n on v(n - 1/2) and on v(n + 1/2)
};

/// v += span (contact - internal)/m for the first `n` nodes.
using KickNodes = KickSums(const KickRows& nodes, double span, std::ptrdiff_t n);

template <class Target>
KickSums kick_nodes(const KickRows& nodes, double span, std::ptrdiff_t n);
template <>
KickSums kick_nodes<simd::Scalar>(const KickRows& nodes, double span, std::ptrdiff_t n);
template <>
KickSums kick_nodes<simd::Avx2>(const KickRows& nodes, double span, std::ptrdiff_t n);
template <>
KickSums kick_nodes<simd::Avx512>(const KickRows& nodes, double span, std::ptrdiff_t n);

}  // namespace interply::mechanics
