/// Several elements or nodes at once. A kernel is written once, as templates over `Real`, which is a pack of doubles
/// (an xsimd batch) or one double, and over `Lanes`, which says where in the arrays the pack lies. For kernel sources
/// only (simd/target.hpp): everything here has internal linkage, as the sources are compiled for different machines.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <xsimd/xsimd.hpp>

#if defined(INTERPLY_TARGET_AVX512) || defined(INTERPLY_TARGET_AVX2)
#include "simd/exp_log.hpp"
#endif
#include "simd/target.hpp"

namespace interply::simd {
namespace {

using Index = std::ptrdiff_t;

#if defined(INTERPLY_TARGET_AVX512)
using Target = Avx512;
using Pack = xsimd::batch<double, xsimd::avx512dq>;
#elif defined(INTERPLY_TARGET_AVX2)
using Target = Avx2;
using Pack = xsimd::batch<double, xsimd::fma3<xsimd::avx2> >;
#else
using Target = Scalar;
using Pack = double;
#endif

/// Result of a comparison of `Real`s.
template <class Real>
struct Traits {
  static constexpr int kWidth = static_cast<int>(Real::size);
  using Mask = typename Real::batch_bool_type;
};
template <>
struct Traits<double> {
  static constexpr int kWidth = 1;
  using Mask = bool;
};
template <class Real>
inline constexpr int kWidth = Traits<Real>::kWidth;
template <class Real>
using Mask = typename Traits<Real>::Mask;

// The same names for packs and for single doubles.
inline double sqrt(double a) { return std::sqrt(a); }
inline double fuse(double a, double b, double c) { return std::fma(a, b, c); }  // a b + c, rounded once
inline double exp(double a) { return std::exp(a); }
inline double log(double a) { return std::log(a); }
inline double atan(double a) { return std::atan(a); }
inline double abs(double a) { return std::fabs(a); }
inline double max(double a, double b) { return a < b ? b : a; }
inline double min(double a, double b) { return b < a ? b : a; }
inline double select(bool m, double a, double b) { return m ? a : b; }
inline bool any(bool m) { return m; }
inline bool all(bool m) { return m; }
#if defined(INTERPLY_TARGET_AVX512) || defined(INTERPLY_TARGET_AVX2)
inline Pack sqrt(Pack a) { return xsimd::sqrt(a); }
inline Pack exp(Pack a) { return compute_exp(a); }
inline Pack log(Pack a) { return compute_log(a); }
inline Pack atan(Pack a) { return xsimd::atan(a); }
inline Pack abs(Pack a) { return xsimd::abs(a); }
inline Pack max(Pack a, Pack b) { return select(a < b, b, a); }
inline Pack min(Pack a, Pack b) { return select(b < a, b, a); }
inline Pack select(Mask<Pack> m, Pack a, Pack b) { return xsimd::select(m, a, b); }
inline bool any(Mask<Pack> m) { return xsimd::any(m); }
inline bool all(Mask<Pack> m) { return xsimd::all(m); }
#endif
/// The first `kWidth` numbers of a row.
#if defined(INTERPLY_TARGET_AVX512)
inline Pack widen(const signed char* row) {
  return _mm512_cvtepi32_pd(_mm256_cvtepi8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(row))));
}
#elif defined(INTERPLY_TARGET_AVX2)
inline Pack widen(const signed char* row) { return _mm256_cvtepi32_pd(_mm_cvtepi8_epi32(_mm_loadu_si32(row))); }
#else
inline Pack widen(const signed char* row) { return *row; }
#endif

/// `a` to or from `kWidth` doubles of an array on a 64-byte boundary.
template <class Real>
inline void write_lanes(double* values, const Real& a) {
  if constexpr (kWidth<Real> == 1)
    *values = a;
  else
    a.store_aligned(values);
}
template <class Real>
inline Real read_lanes(const double* values) {
  if constexpr (kWidth<Real> == 1)
    return *values;
  else
    return Real::load_aligned(values);
}

template <class Real>
struct Vec3 {
  Real x, y, z;

  friend Vec3 operator+(const Vec3& a, const Vec3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend Vec3 operator-(const Vec3& a, const Vec3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend Vec3 operator*(const Real& s, const Vec3& a) { return {s * a.x, s * a.y, s * a.z}; }
  Vec3& operator+=(const Vec3& b) { return *this = *this + b; }
  Vec3& operator-=(const Vec3& b) { return *this = *this - b; }
};
template <class Real>
inline Real dot(const Vec3<Real>& a, const Vec3<Real>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class Real>
inline Vec3<Real> cross(const Vec3<Real>& a, const Vec3<Real>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

/// The points begin ... begin + count - 1 of arrays whose rows are contiguous over the points. A partial pack at the
/// end of an array repeats its last point and stores nothing for the repetitions.
template <class Real, bool kPartial>
class Lanes {
 public:
  static constexpr int kWidth = simd::kWidth<Real>;
  using Indices = std::array<int, kWidth>;

  Lanes(Index begin, int count) : begin_(begin), count_(count) {}
  Lanes moved(Index by) const { return {begin_ + by, count_}; }
  Index begin() const { return begin_; }
  int count() const { return kPartial ? count_ : kWidth; }

  Real load(const double* row) const {
    if constexpr (kWidth == 1) {
      return row[begin_];
    } else if constexpr (!kPartial) {
      return Real::load_unaligned(row + begin_);
    } else {
      alignas(64) double values[kWidth];
      for (int l = 0; l < kWidth; ++l) values[l] = row[at(l)];
      return Real::load_aligned(values);
    }
  }
  void store(double* row, const Real& a) const {
    if constexpr (kWidth == 1) {
      row[begin_] = a;
    } else if constexpr (!kPartial) {
      a.store_unaligned(row + begin_);
    } else {
      alignas(64) double values[kWidth];
      a.store_aligned(values);
      for (int l = 0; l < count_; ++l) row[begin_ + l] = values[l];
    }
  }
  Real load(const signed char* row) const {
    if constexpr (kWidth == 1) {
      return row[begin_];
    } else if constexpr (!kPartial) {
      return widen(row + begin_);
    } else {
      alignas(64) double values[kWidth];
      for (int l = 0; l < kWidth; ++l) values[l] = row[at(l)];
      return Real::load_aligned(values);
    }
  }
  Indices load(const int* row) const {
    Indices i;
    for (int l = 0; l < kWidth; ++l) i[l] = row[kPartial ? at(l) : begin_ + l];
    return i;
  }
  Vec3<Real> load(const double* x, const double* y, const double* z) const { return {load(x), load(y), load(z)}; }
  void store(double* x, double* y, double* z, const Vec3<Real>& a) const {
    store(x, a.x);
    store(y, a.y);
    store(z, a.z);
  }

 private:
  Index at(int l) const { return begin_ + (l < count_ ? l : count_ - 1); }

  Index begin_;
  int count_;
};

/// row[i] of each lane.
template <class Real, std::size_t kN>
inline Real gather(const double* row, const std::array<int, kN>& i) {
  if constexpr (kN == 1) {
    return row[i[0]];
  } else if constexpr (kN == 4) {
    return Real{row[i[0]], row[i[1]], row[i[2]], row[i[3]]};
  } else {
    static_assert(kN == 8);
    return Real{row[i[0]], row[i[1]], row[i[2]], row[i[3]], row[i[4]], row[i[5]], row[i[6]], row[i[7]]};
  }
}
template <class Real, std::size_t kN>
inline Vec3<Real> gather(const double* x, const double* y, const double* z, const std::array<int, kN>& i) {
  return {gather<Real>(x, i), gather<Real>(y, i), gather<Real>(z, i)};
}

/// body(lanes) for the points [begin, end), `Real`s at a time. The last points beyond a multiple of eight go through
/// partial packs whatever the width: the compiler rounds their arithmetic in its own way, so the same points must.
template <class Real, class Body>
inline void for_each_pack(Index begin, Index end, const Body& body) {
  constexpr Index kMost = kWidth<Real> == 1 ? 1 : 8;
  Index i = begin;
  for (const Index whole = end - (end - begin) % kMost; i < whole; i += kWidth<Real>)
    body(Lanes<Real, false>(i, kWidth<Real>));
  if constexpr (kWidth < Real >> 1)
    for (; i < end; i += kWidth<Real>)
      body(Lanes<Real, true>(i, static_cast<int>(end - i < kWidth<Real> ? end - i : kWidth<Real>)));
}

/// A sum over the points of a block that is the same for every width: eight partial sums, point i of the block in i
/// % 8.
template <class Real>
class Sum {
 public:
  explicit Sum(Index begin) : begin_(begin) {}
  template <bool kPartial>
  void add(const Lanes<Real, kPartial>& lanes, const Real& a) {
    double* at = partial_ + (lanes.begin() - begin_) % 8;
    if constexpr (kWidth<Real> == 1) {
      *at += a;
    } else if constexpr (!kPartial) {
      (Real::load_aligned(at) + a).store_aligned(at);
    } else {
      alignas(64) double values[kWidth<Real>];
      a.store_aligned(values);
      for (int l = 0; l < lanes.count(); ++l) at[l] += values[l];
    }
  }
  double total() const {
    double sum = 0;
    for (const double p : partial_) sum += p;
    return sum;
  }

 private:
  alignas(64) double partial_[8] = {};
  Index begin_;
};

}  // namespace
}  // namespace interply::simd
