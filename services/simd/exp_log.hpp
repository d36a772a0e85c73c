/// exp and log of packs with the same bits in every width: explicit fused operations throughout. Included by
/// simd/pack.hpp. (xsimd 8.1 leaves the fusing to the compiler for AVX-512: one last bit in 5000 differs from AVX2.)
#pragma once

#include <limits>
#include <xsimd/xsimd.hpp>

namespace interply::simd {
namespace {

inline __m256i to_bits(__m256d a) { return _mm256_castpd_si256(a); }
inline __m256d to_doubles(__m256i a) { return _mm256_castsi256_pd(a); }
inline __m256i add(__m256i a, __m256i b) { return _mm256_add_epi64(a, b); }
inline __m256i subtract(__m256i a, __m256i b) { return _mm256_sub_epi64(a, b); }
inline __m256i to_exponent(__m256i a) { return _mm256_slli_epi64(a, 52); }
inline __m256i from_exponent(__m256i a) { return _mm256_srli_epi64(a, 52); }
inline __m256d multiply_add(__m256d a, __m256d b, __m256d c) { return _mm256_fmadd_pd(a, b, c); }
#if defined(__AVX512F__)
inline __m512i to_bits(__m512d a) { return _mm512_castpd_si512(a); }
inline __m512d to_doubles(__m512i a) { return _mm512_castsi512_pd(a); }
inline __m512i add(__m512i a, __m512i b) { return _mm512_add_epi64(a, b); }
inline __m512i subtract(__m512i a, __m512i b) { return _mm512_sub_epi64(a, b); }
inline __m512i to_exponent(__m512i a) { return _mm512_slli_epi64(a, 52); }
inline __m512i from_exponent(__m512i a) { return _mm512_srli_epi64(a, 52); }
inline __m512d multiply_add(__m512d a, __m512d b, __m512d c) { return _mm512_fmadd_pd(a, b, c); }
#endif

/// a b + c, rounded once.
template <class Pack>
inline Pack fuse(const Pack& a, const Pack& b, const Pack& c) {
  using Register = typename Pack::register_type;
  return multiply_add(Register(a), Register(b), Register(c));
}
/// The bits of a double, the same in all lanes.
template <class Pack>
inline auto set_bits(double a) {
  return to_bits(typename Pack::register_type(Pack(a)));
}

// ln 2 in two parts; the product of the first with an exponent is exact
inline constexpr double kRoot = 0x1.6a09e667f3bcdp-1;  // sqrt(1/2)
inline constexpr double kLn2High = 0x1.62e42feep-1, kLn2Low = 0x1.a39ef35793c76p-33;

/// Error below two last bits (1.7 found); 0 below -708, infinite beyond 709, NaN for NaN. With k = round(x / ln 2) and
/// r = x - k ln 2, exp x = 2^k exp r, exp r by its Taylor polynomial of degree 13.
template <class Pack>
inline Pack compute_exp(const Pack& x) {
  using Register = typename Pack::register_type;
  const Pack shift(0x1.8p52);  // a double beyond it has no fraction
  const Pack inside = xsimd::select(x > Pack(709.0), Pack(709.0), xsimd::select(x < Pack(-708.0), Pack(-708.0), x));
  const Pack shifted = fuse(inside, Pack(0x1.71547652b82fep0), shift);
  const Pack k = shifted - shift;
  const Pack r = fuse(k, Pack(-kLn2Low), fuse(k, Pack(-kLn2High), inside));
  const Pack r2 = r * r, r4 = r2 * r2;
  const Pack p0 = fuse(r, Pack(1.0), Pack(1.0)), p2 = fuse(r, Pack(1.0 / 6), Pack(1.0 / 2));
  const Pack p4 = fuse(r, Pack(1.0 / 120), Pack(1.0 / 24)), p6 = fuse(r, Pack(1.0 / 5040), Pack(1.0 / 720));
  const Pack p8 = fuse(r, Pack(1.0 / 362880), Pack(1.0 / 40320));
  const Pack p10 = fuse(r, Pack(1.0 / 39916800), Pack(1.0 / 3628800));
  const Pack p12 = fuse(r, Pack(1.0 / 6227020800.0), Pack(1.0 / 479001600));
  const Pack high = fuse(r4, fuse(r4, p12, fuse(r2, p10, p8)), fuse(r2, p6, p4));
  const Pack value = fuse(r4, high, fuse(r2, p2, p0));
  // the last bits of `shifted` are k
  const auto bits = subtract(to_bits(Register(shifted)), set_bits<Pack>(0x1.8p52 - 1023));
  const Pack result = value * Pack(to_doubles(to_exponent(bits)));
  const Pack infinity(std::numeric_limits<double>::infinity());
  return xsimd::select(x > Pack(709.0), infinity, xsimd::select(x < Pack(-708.0), Pack(0.0), result));
}

/// Error below one last bit (0.83 found). NaN for negative numbers and NaN, -infinity for all from 0 to less than
/// 1e-307. x = 2^k (1 + f) with 1 + f in [sqrt(1/2), sqrt(2)), log(1 + f) = 2 artanh s, s = f/(2 + f), by the
/// polynomial of fdlibm (Sun Microsystems 1993).
template <class Pack>
inline Pack compute_log(const Pack& x) {
  const auto bits = to_bits(typename Pack::register_type(x)), one = set_bits<Pack>(1.0);
  const auto exponent = from_exponent(add(subtract(bits, set_bits<Pack>(kRoot)), one));  // k + 1023
  const Pack k = Pack(to_doubles(add(exponent, set_bits<Pack>(0x1p52)))) - Pack(0x1p52 + 1023);
  const Pack f = Pack(to_doubles(add(subtract(bits, to_exponent(exponent)), one))) - Pack(1.0);
  const Pack s = f / (Pack(2.0) + f), z = s * s, w = z * z;
  const Pack half_square = fuse(Pack(0.5) * f, f, Pack(0.0));  // so that the compiler does not
  const Pack even =
      fuse(w, fuse(w, Pack(0x1.39a09d078c69fp-3), Pack(0x1.c71c51d8e78afp-3)), Pack(0x1.999999997fa04p-2));
  const Pack odd =
      fuse(w, fuse(w, fuse(w, Pack(0x1.2f112df3e5244p-3), Pack(0x1.7466496cb03dep-3)), Pack(0x1.2492494229359p-2)),
           Pack(0x1.5555555555593p-1));
  const Pack rest = fuse(z, odd, w * even);
  const Pack small = fuse(s, half_square + rest, k * Pack(kLn2Low)) - half_square;
  const Pack result = fuse(k, Pack(kLn2High), small + f);
  const Pack infinity(std::numeric_limits<double>::infinity()), nan(std::numeric_limits<double>::quiet_NaN());
  const Pack below = xsimd::select(x < Pack(0.0), nan, -infinity);
  return xsimd::select(x < Pack(1e-307), below, xsimd::select(x < infinity, result, x));
}

}  // namespace
}  // namespace interply::simd
