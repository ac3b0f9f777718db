// The vectors of lanes.h on x86: AVX2, for which the whole program is compiled, and AVX-512 in units compiled for it.
// Only lanes.h includes this file.
#pragma once

#include <immintrin.h>

namespace wobble::physics {

inline constexpr int kBaselineBytes = 32;  // of a vector of the kernels that every processor runs

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

}  // namespace wobble::physics
