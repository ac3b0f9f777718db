// The room physics/lanes holds the kernels: the hot loops of the engine, compiled once for each instruction set. This
// file: arithmetic on vectors of W numbers, the same bits in every lane whatever W is. A lane is a body, a spring, a
// contact or a column of a grid, as each kernel says.
//
// Compiler vector types and, where they have no operator, one intrinsic. Rejected: Highway, measured on the sweep of
// sweep.h (162-vertex ball, g++ 12, AMD EPYC with AVX-512): vector types took 12.1 and Highway 12.5 ns a vertex and
// step at W = 16, 17.6 and 18.4 at W = 8; and vector types need no wrapper round + − × ÷, so the sweep reads like the
// formula.
//
// Only operations that every instruction set rounds correctly: sums, products, quotients, square roots and fused
// multiply-adds. So results do not depend on the instruction set. Estimates such as rsqrtps are left out: their bits
// differ between vendors.
#pragma once

#include <immintrin.h>

#define WOBBLE_LANES static inline __attribute__((always_inline))

namespace wobble::physics {

template <class Real, int W>
struct LanesOf;

template <>
struct LanesOf<float, 1> {
  using Type = float;
};
template <>
struct LanesOf<double, 1> {
  using Type = double;
};

// Fma(a, b, c) = ab + c, Fms(a, b, c) = ab − c, Fnma(a, b, c) = c − ab, each rounded once. FindBelow(a, b): bit i is
// set if a < b in lane i. Max(a, b) and Min(a, b) return b if either is a NaN.
WOBBLE_LANES float Fma(float a, float b, float c) { return __builtin_fmaf(a, b, c); }
WOBBLE_LANES float Fms(float a, float b, float c) { return __builtin_fmaf(a, b, -c); }
WOBBLE_LANES float Fnma(float a, float b, float c) { return __builtin_fmaf(-a, b, c); }
WOBBLE_LANES float Sqrt(float a) { return __builtin_sqrtf(a); }
WOBBLE_LANES float Max(float a, float b) { return a > b ? a : b; }
WOBBLE_LANES float Min(float a, float b) { return a < b ? a : b; }
WOBBLE_LANES unsigned FindBelow(float a, float b) { return a < b ? 1U : 0U; }
WOBBLE_LANES void Fill(float& lanes, float value) { lanes = value; }

WOBBLE_LANES double Fma(double a, double b, double c) { return __builtin_fma(a, b, c); }
WOBBLE_LANES double Fms(double a, double b, double c) { return __builtin_fma(a, b, -c); }
WOBBLE_LANES double Fnma(double a, double b, double c) { return __builtin_fma(-a, b, c); }
WOBBLE_LANES double Sqrt(double a) { return __builtin_sqrt(a); }
WOBBLE_LANES double Max(double a, double b) { return a > b ? a : b; }
WOBBLE_LANES double Min(double a, double b) { return a < b ? a : b; }
WOBBLE_LANES unsigned FindBelow(double a, double b) { return a < b ? 1U : 0U; }
WOBBLE_LANES void Fill(double& lanes, double value) { lanes = value; }

#ifdef __AVX2__
template <>
struct LanesOf<float, 8> {
  using Type = __m256;
};
template <>
struct LanesOf<double, 4> {
  using Type = __m256d;
};

WOBBLE_LANES __m128 Fma(__m128 a, __m128 b, __m128 c) { return _mm_fmadd_ps(a, b, c); }
WOBBLE_LANES __m128 Fms(__m128 a, __m128 b, __m128 c) { return _mm_fmsub_ps(a, b, c); }
WOBBLE_LANES __m128 Fnma(__m128 a, __m128 b, __m128 c) { return _mm_fnmadd_ps(a, b, c); }
WOBBLE_LANES void Fill(__m128& lanes, float value) { lanes = _mm_set1_ps(value); }

WOBBLE_LANES __m256 Fma(__m256 a, __m256 b, __m256 c) { return _mm256_fmadd_ps(a, b, c); }
WOBBLE_LANES __m256 Fms(__m256 a, __m256 b, __m256 c) { return _mm256_fmsub_ps(a, b, c); }
WOBBLE_LANES __m256 Fnma(__m256 a, __m256 b, __m256 c) { return _mm256_fnmadd_ps(a, b, c); }
WOBBLE_LANES __m256 Sqrt(__m256 a) { return _mm256_sqrt_ps(a); }
WOBBLE_LANES __m256 Max(__m256 a, __m256 b) { return _mm256_max_ps(a, b); }
WOBBLE_LANES __m256 Min(__m256 a, __m256 b) { return _mm256_min_ps(a, b); }
WOBBLE_LANES unsigned FindBelow(__m256 a, __m256 b) {
  return static_cast<unsigned>(_mm256_movemask_ps(_mm256_cmp_ps(a, b, _CMP_LT_OQ)));
}
WOBBLE_LANES void Fill(__m256& lanes, float value) { lanes = _mm256_set1_ps(value); }

WOBBLE_LANES __m256d Fma(__m256d a, __m256d b, __m256d c) { return _mm256_fmadd_pd(a, b, c); }
WOBBLE_LANES __m256d Fms(__m256d a, __m256d b, __m256d c) { return _mm256_fmsub_pd(a, b, c); }
WOBBLE_LANES __m256d Fnma(__m256d a, __m256d b, __m256d c) { return _mm256_fnmadd_pd(a, b, c); }
WOBBLE_LANES __m256d Sqrt(__m256d a) { return _mm256_sqrt_pd(a); }
WOBBLE_LANES __m256d Max(__m256d a, __m256d b) { return _mm256_max_pd(a, b); }
WOBBLE_LANES __m256d Min(__m256d a, __m256d b) { return _mm256_min_pd(a, b); }
WOBBLE_LANES unsigned FindBelow(__m256d a, __m256d b) {
  return static_cast<unsigned>(_mm256_movemask_pd(_mm256_cmp_pd(a, b, _CMP_LT_OQ)));
}
WOBBLE_LANES void Fill(__m256d& lanes, double value) { lanes = _mm256_set1_pd(value); }
#endif

#ifdef __AVX512F__
template <>
struct LanesOf<float, 16> {
  using Type = __m512;
};
template <>
struct LanesOf<double, 8> {
  using Type = __m512d;
};

WOBBLE_LANES __m512 Fma(__m512 a, __m512 b, __m512 c) { return _mm512_fmadd_ps(a, b, c); }
WOBBLE_LANES __m512 Fms(__m512 a, __m512 b, __m512 c) { return _mm512_fmsub_ps(a, b, c); }
WOBBLE_LANES __m512 Fnma(__m512 a, __m512 b, __m512 c) { return _mm512_fnmadd_ps(a, b, c); }
WOBBLE_LANES __m512 Sqrt(__m512 a) { return _mm512_sqrt_ps(a); }
WOBBLE_LANES __m512 Max(__m512 a, __m512 b) { return _mm512_max_ps(a, b); }
WOBBLE_LANES __m512 Min(__m512 a, __m512 b) { return _mm512_min_ps(a, b); }
WOBBLE_LANES unsigned FindBelow(__m512 a, __m512 b) { return _mm512_cmp_ps_mask(a, b, _CMP_LT_OQ); }
WOBBLE_LANES void Fill(__m512& lanes, float value) { lanes = _mm512_set1_ps(value); }

WOBBLE_LANES __m512d Fma(__m512d a, __m512d b, __m512d c) { return _mm512_fmadd_pd(a, b, c); }
WOBBLE_LANES __m512d Fms(__m512d a, __m512d b, __m512d c) { return _mm512_fmsub_pd(a, b, c); }
WOBBLE_LANES __m512d Fnma(__m512d a, __m512d b, __m512d c) { return _mm512_fnmadd_pd(a, b, c); }
WOBBLE_LANES __m512d Sqrt(__m512d a) { return _mm512_sqrt_pd(a); }
WOBBLE_LANES __m512d Max(__m512d a, __m512d b) { return _mm512_max_pd(a, b); }
WOBBLE_LANES __m512d Min(__m512d a, __m512d b) { return _mm512_min_pd(a, b); }
WOBBLE_LANES unsigned FindBelow(__m512d a, __m512d b) { return _mm512_cmp_pd_mask(a, b, _CMP_LT_OQ); }
WOBBLE_LANES void Fill(__m512d& lanes, double value) { lanes = _mm512_set1_pd(value); }
#endif

template <class V, class Real>
WOBBLE_LANES V Spread(Real value) {
  V lanes;
  Fill(lanes, value);
  return lanes;
}

}  // namespace wobble::physics

#undef WOBBLE_LANES
