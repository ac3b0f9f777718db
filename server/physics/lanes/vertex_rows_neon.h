// The rows of vertex_rows.h by NEON: four floats are a register, four doubles a pair. Only vertex_rows.h includes this
// file, which says the same as vertex_rows_avx.h, where more is commented.
#pragma once

namespace wobble::physics {

template <>
struct RowsOf<float> {
  using Row = Floats4;
  using Lanes = Floats8;  // two rows, or one number of eight vertices
};
template <>
struct RowsOf<double> {
  using Row = Doubles4;
  using Lanes = Doubles4;
};

WOBBLE_INLINE Floats4 LoadRow(const float* from) { return vld1q_f32(from); }
WOBBLE_INLINE Doubles4 LoadRow(const double* from) { return Join(vld1q_f64(from), vld1q_f64(from + 2)); }
WOBBLE_INLINE void StoreRow(Floats4 row, float* to) { vst1q_f32(to, row); }
WOBBLE_INLINE void StoreRow(Doubles4 row, double* to) {
  vst1q_f64(to, Low(row));
  vst1q_f64(to + 2, High(row));
}

WOBBLE_INLINE Floats8 LoadLanes(const float* from) { return Join(vld1q_f32(from), vld1q_f32(from + 4)); }
WOBBLE_INLINE Doubles4 LoadLanes(const double* from) { return LoadRow(from); }
WOBBLE_INLINE void StoreLanes(Floats8 lanes, float* to) {
  vst1q_f32(to, Low(lanes));
  vst1q_f32(to + 4, High(lanes));
}
WOBBLE_INLINE void StoreLanes(Doubles4 lanes, double* to) { StoreRow(lanes, to); }

// A row of two numbers and two zeros.
WOBBLE_INLINE Floats4 LoadHalf(const float* from) { return vcombine_f32(vld1_f32(from), vdup_n_f32(0)); }
WOBBLE_INLINE Doubles4 LoadHalf(const double* from) { return Join(vld1q_f64(from), vdupq_n_f64(0)); }
WOBBLE_INLINE void StoreHalf(Floats4 row, float* to) { vst1_f32(to, vget_low_f32(row)); }
WOBBLE_INLINE void StoreHalf(Doubles4 row, double* to) { vst1q_f64(to, Low(row)); }

// A row of three numbers and a zero; reads nothing behind them.
WOBBLE_INLINE Floats4 LoadThree(const float* from) { return vsetq_lane_f32(from[2], LoadHalf(from), 2); }
WOBBLE_INLINE Doubles4 LoadThree(const double* from) {
  return Join(vld1q_f64(from), vsetq_lane_f64(from[2], vdupq_n_f64(0), 0));
}
// Such a row, and beside it that of b where two rows fit.
WOBBLE_INLINE Floats8 LoadThrees(const float* a, const float* b) { return Join(LoadThree(a), LoadThree(b)); }
WOBBLE_INLINE Doubles4 LoadThrees(const double* a, const double*) { return LoadThree(a); }
WOBBLE_INLINE Floats4 MinOf(Floats4 a, Floats4 b) { return Min(a, b); }
WOBBLE_INLINE Doubles4 MinOf(Doubles4 a, Doubles4 b) { return Min(a, b); }
WOBBLE_INLINE Floats4 MaxOf(Floats4 a, Floats4 b) { return Max(a, b); }
WOBBLE_INLINE Doubles4 MaxOf(Doubles4 a, Doubles4 b) { return Max(a, b); }

// x y z w becomes y z x w.
WOBBLE_INLINE Floats4 Turn(Floats4 row) { return __builtin_shufflevector(row, row, 1, 2, 0, 3); }
WOBBLE_INLINE Doubles4 Turn(Doubles4 row) { return __builtin_shufflevector(row, row, 1, 2, 0, 3); }
// x y z w becomes y z w x.
WOBBLE_INLINE Floats4 Rotate(Floats4 row) { return __builtin_shufflevector(row, row, 1, 2, 3, 0); }
WOBBLE_INLINE Doubles4 Rotate(Doubles4 row) { return __builtin_shufflevector(row, row, 1, 2, 3, 0); }
// x y z of a, then x of b.
WOBBLE_INLINE Floats4 AppendFirst(Floats4 a, Floats4 b) { return __builtin_shufflevector(a, b, 0, 1, 2, 4); }
WOBBLE_INLINE Doubles4 AppendFirst(Doubles4 a, Doubles4 b) { return __builtin_shufflevector(a, b, 0, 1, 2, 4); }

// Row a, and beside it row b where two rows fit.
WOBBLE_INLINE Floats8 LoadRows(const float* a, const float* b) { return Join(vld1q_f32(a), vld1q_f32(b)); }
WOBBLE_INLINE Doubles4 LoadRows(const double* a, const double*) { return LoadRow(a); }
WOBBLE_INLINE Floats4 FindRow(Floats8 rows, bool second) { return second ? High(rows) : Low(rows); }
WOBBLE_INLINE Doubles4 FindRow(Doubles4 rows, bool) { return rows; }
// The first or second row of a, and beside it that of b.
WOBBLE_INLINE Floats8 JoinRows(Floats8 a, Floats8 b, bool second) {
  return second ? Join(High(a), High(b)) : Join(Low(a), Low(b));
}

// Transposes: rows of vertices 0 to 3 (and 4 to 7 beside them) become x, y, z, w of all, and the other way round.
WOBBLE_INLINE void Transpose(Floats4 (&rows)[4]) {
  const Floats4 xz01 = vtrn1q_f32(rows[0], rows[1]);  // x₀ x₁ z₀ z₁
  const Floats4 yw01 = vtrn2q_f32(rows[0], rows[1]);
  const Floats4 xz23 = vtrn1q_f32(rows[2], rows[3]);
  const Floats4 yw23 = vtrn2q_f32(rows[2], rows[3]);
  rows[0] = __builtin_shufflevector(xz01, xz23, 0, 1, 4, 5);
  rows[1] = __builtin_shufflevector(yw01, yw23, 0, 1, 4, 5);
  rows[2] = __builtin_shufflevector(xz01, xz23, 2, 3, 6, 7);
  rows[3] = __builtin_shufflevector(yw01, yw23, 2, 3, 6, 7);
}
WOBBLE_INLINE void Transpose(Floats8 (&rows)[4]) {
  Floats4 low[4] = {Low(rows[0]), Low(rows[1]), Low(rows[2]), Low(rows[3])};
  Floats4 high[4] = {High(rows[0]), High(rows[1]), High(rows[2]), High(rows[3])};
  Transpose(low);
  Transpose(high);
  for (int i = 0; i < 4; ++i) rows[i] = Join(low[i], high[i]);
}
WOBBLE_INLINE void Transpose(Doubles4 (&rows)[4]) {
  const Doubles4 a = rows[0], b = rows[1], c = rows[2], d = rows[3];
  rows[0] = Join(vtrn1q_f64(Low(a), Low(b)), vtrn1q_f64(Low(c), Low(d)));
  rows[1] = Join(vtrn2q_f64(Low(a), Low(b)), vtrn2q_f64(Low(c), Low(d)));
  rows[2] = Join(vtrn1q_f64(High(a), High(b)), vtrn1q_f64(High(c), High(d)));
  rows[3] = Join(vtrn2q_f64(High(a), High(b)), vtrn2q_f64(High(c), High(d)));
}

}  // namespace wobble::physics
