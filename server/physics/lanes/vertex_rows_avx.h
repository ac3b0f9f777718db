// The rows of vertex_rows.h by AVX2. Only vertex_rows.h includes this file.
#pragma once

#include <immintrin.h>

namespace wobble::physics {

template <>
struct RowsOf<float> {
  using Row = __m128;
  using Lanes = __m256;  // two rows, or one number of eight vertices
};
template <>
struct RowsOf<double> {
  using Row = __m256d;
  using Lanes = __m256d;
};

WOBBLE_INLINE __m128 LoadRow(const float* from) { return _mm_loadu_ps(from); }
WOBBLE_INLINE __m256d LoadRow(const double* from) { return _mm256_loadu_pd(from); }
WOBBLE_INLINE void StoreRow(__m128 row, float* to) { _mm_storeu_ps(to, row); }
WOBBLE_INLINE void StoreRow(__m256d row, double* to) { _mm256_storeu_pd(to, row); }

WOBBLE_INLINE __m256 LoadLanes(const float* from) { return _mm256_loadu_ps(from); }
WOBBLE_INLINE __m256d LoadLanes(const double* from) { return _mm256_loadu_pd(from); }
WOBBLE_INLINE void StoreLanes(__m256 lanes, float* to) { _mm256_storeu_ps(to, lanes); }
WOBBLE_INLINE void StoreLanes(__m256d lanes, double* to) { _mm256_storeu_pd(to, lanes); }

// A row of two numbers and two zeros.
WOBBLE_INLINE __m128 LoadHalf(const float* from) { return _mm_castsi128_ps(_mm_loadu_si64(from)); }
WOBBLE_INLINE __m256d LoadHalf(const double* from) { return _mm256_zextpd128_pd256(_mm_loadu_pd(from)); }
WOBBLE_INLINE void StoreHalf(__m128 row, float* to) { _mm_storeu_si64(to, _mm_castps_si128(row)); }
WOBBLE_INLINE void StoreHalf(__m256d row, double* to) { _mm_storeu_pd(to, _mm256_castpd256_pd128(row)); }

// A row of three numbers and a zero; reads nothing behind them.
WOBBLE_INLINE __m128 LoadThree(const float* from) { return _mm_maskload_ps(from, _mm_setr_epi32(-1, -1, -1, 0)); }
WOBBLE_INLINE __m256d LoadThree(const double* from) {
  return _mm256_maskload_pd(from, _mm256_setr_epi64x(-1, -1, -1, 0));
}
// Such a row, and beside it that of b where two rows fit.
WOBBLE_INLINE __m256 LoadThrees(const float* a, const float* b) {
  return _mm256_insertf128_ps(_mm256_castps128_ps256(LoadThree(a)), LoadThree(b), 1);
}
WOBBLE_INLINE __m256d LoadThrees(const double* a, const double*) { return LoadThree(a); }
WOBBLE_INLINE __m128 MinOf(__m128 a, __m128 b) { return _mm_min_ps(a, b); }
WOBBLE_INLINE __m256d MinOf(__m256d a, __m256d b) { return _mm256_min_pd(a, b); }
WOBBLE_INLINE __m128 MaxOf(__m128 a, __m128 b) { return _mm_max_ps(a, b); }
WOBBLE_INLINE __m256d MaxOf(__m256d a, __m256d b) { return _mm256_max_pd(a, b); }

// x y z w becomes y z x w.
WOBBLE_INLINE __m128 Turn(__m128 row) { return _mm_shuffle_ps(row, row, _MM_SHUFFLE(3, 0, 2, 1)); }
WOBBLE_INLINE __m256d Turn(__m256d row) { return _mm256_permute4x64_pd(row, _MM_SHUFFLE(3, 0, 2, 1)); }
// x y z w becomes y z w x.
WOBBLE_INLINE __m128 Rotate(__m128 row) { return _mm_shuffle_ps(row, row, _MM_SHUFFLE(0, 3, 2, 1)); }
WOBBLE_INLINE __m256d Rotate(__m256d row) { return _mm256_permute4x64_pd(row, _MM_SHUFFLE(0, 3, 2, 1)); }
// x y z of a, then x of b.
WOBBLE_INLINE __m128 AppendFirst(__m128 a, __m128 b) { return _mm_insert_ps(a, b, 0x30); }
WOBBLE_INLINE __m256d AppendFirst(__m256d a, __m256d b) {
  return _mm256_blend_pd(a, _mm256_permute4x64_pd(b, _MM_SHUFFLE(0, 0, 0, 0)), 8);
}

// Row a, and beside it row b where two rows fit.
WOBBLE_INLINE __m256 LoadRows(const float* a, const float* b) {
  return _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(a)), _mm_loadu_ps(b), 1);
}
WOBBLE_INLINE __m256d LoadRows(const double* a, const double*) { return _mm256_loadu_pd(a); }
WOBBLE_INLINE __m128 FindRow(__m256 rows, bool second) {
  return second ? _mm256_extractf128_ps(rows, 1) : _mm256_castps256_ps128(rows);
}
WOBBLE_INLINE __m256d FindRow(__m256d rows, bool) { return rows; }
// The first or second row of a, and beside it that of b.
WOBBLE_INLINE __m256 JoinRows(__m256 a, __m256 b, bool second) {
  return second ? _mm256_permute2f128_ps(a, b, 0x31) : _mm256_permute2f128_ps(a, b, 0x20);
}

// Transposes: rows of vertices 0 to 3 (and 4 to 7 beside them) become x, y, z, w of all, and the other way round.
WOBBLE_INLINE void Transpose(__m256 (&rows)[4]) {
  const __m256 xy01 = _mm256_unpacklo_ps(rows[0], rows[1]);
  const __m256 zw01 = _mm256_unpackhi_ps(rows[0], rows[1]);
  const __m256 xy23 = _mm256_unpacklo_ps(rows[2], rows[3]);
  const __m256 zw23 = _mm256_unpackhi_ps(rows[2], rows[3]);
  rows[0] = _mm256_shuffle_ps(xy01, xy23, _MM_SHUFFLE(1, 0, 1, 0));
  rows[1] = _mm256_shuffle_ps(xy01, xy23, _MM_SHUFFLE(3, 2, 3, 2));
  rows[2] = _mm256_shuffle_ps(zw01, zw23, _MM_SHUFFLE(1, 0, 1, 0));
  rows[3] = _mm256_shuffle_ps(zw01, zw23, _MM_SHUFFLE(3, 2, 3, 2));
}
WOBBLE_INLINE void Transpose(__m256d (&rows)[4]) {
  const __m256d xz01 = _mm256_unpacklo_pd(rows[0], rows[1]);
  const __m256d yw01 = _mm256_unpackhi_pd(rows[0], rows[1]);
  const __m256d xz23 = _mm256_unpacklo_pd(rows[2], rows[3]);
  const __m256d yw23 = _mm256_unpackhi_pd(rows[2], rows[3]);
  rows[0] = _mm256_permute2f128_pd(xz01, xz23, 0x20);
  rows[1] = _mm256_permute2f128_pd(yw01, yw23, 0x20);
  rows[2] = _mm256_permute2f128_pd(xz01, xz23, 0x31);
  rows[3] = _mm256_permute2f128_pd(yw01, yw23, 0x31);
}

}  // namespace wobble::physics
