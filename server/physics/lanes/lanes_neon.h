// The vectors of lanes.h on ARM: NEON's four floats or two doubles, and pairs of them. Packs of bodies have the former.
// The pairs have as many numbers as a vector of AVX2, for code whose sums or searches depend on that number: rows of a
// lone body, surveys of bodies, rings of faces. Only lanes.h includes this file.
//
// Maxima, minima and comparisons are written as x86 defines them: NEON's own maximum of a number and a NaN is a NaN.
#pragma once

#include <arm_neon.h>

namespace wobble::physics {

inline constexpr int kBaselineBytes = 16;  // of a vector of the kernels that every processor runs

typedef float Floats4 __attribute__((vector_size(16), may_alias));
typedef double Doubles2 __attribute__((vector_size(16), may_alias));
typedef float Floats8 __attribute__((vector_size(32), may_alias));
typedef double Doubles4 __attribute__((vector_size(32), may_alias));

template <>
struct LanesOf<float, 4> {
  using Type = Floats4;
};
template <>
struct LanesOf<double, 2> {
  using Type = Doubles2;
};
template <>
struct LanesOf<float, 8> {
  using Type = Floats8;
};
template <>
struct LanesOf<double, 4> {
  using Type = Doubles4;
};

WOBBLE_LANES Floats4 Fma(Floats4 a, Floats4 b, Floats4 c) { return vfmaq_f32(c, a, b); }
WOBBLE_LANES Floats4 Fms(Floats4 a, Floats4 b, Floats4 c) { return vfmaq_f32(-c, a, b); }
WOBBLE_LANES Floats4 Fnma(Floats4 a, Floats4 b, Floats4 c) { return vfmsq_f32(c, a, b); }
WOBBLE_LANES Floats4 Sqrt(Floats4 a) { return vsqrtq_f32(a); }
WOBBLE_LANES Floats4 Max(Floats4 a, Floats4 b) { return a > b ? a : b; }
WOBBLE_LANES Floats4 Min(Floats4 a, Floats4 b) { return a < b ? a : b; }
WOBBLE_LANES unsigned FindBelow(Floats4 a, Floats4 b) {
  return vaddvq_u32(vandq_u32(vcltq_f32(a, b), uint32x4_t{1, 2, 4, 8}));
}
WOBBLE_LANES void Fill(Floats4& lanes, float value) { lanes = vdupq_n_f32(value); }

WOBBLE_LANES Doubles2 Fma(Doubles2 a, Doubles2 b, Doubles2 c) { return vfmaq_f64(c, a, b); }
WOBBLE_LANES Doubles2 Fms(Doubles2 a, Doubles2 b, Doubles2 c) { return vfmaq_f64(-c, a, b); }
WOBBLE_LANES Doubles2 Fnma(Doubles2 a, Doubles2 b, Doubles2 c) { return vfmsq_f64(c, a, b); }
WOBBLE_LANES Doubles2 Sqrt(Doubles2 a) { return vsqrtq_f64(a); }
WOBBLE_LANES Doubles2 Max(Doubles2 a, Doubles2 b) { return a > b ? a : b; }
WOBBLE_LANES Doubles2 Min(Doubles2 a, Doubles2 b) { return a < b ? a : b; }
WOBBLE_LANES unsigned FindBelow(Doubles2 a, Doubles2 b) {
  return static_cast<unsigned>(vaddvq_u64(vandq_u64(vcltq_f64(a, b), uint64x2_t{1, 2})));
}
WOBBLE_LANES void Fill(Doubles2& lanes, double value) { lanes = vdupq_n_f64(value); }

WOBBLE_LANES Floats4 Low(Floats8 pair) { return __builtin_shufflevector(pair, pair, 0, 1, 2, 3); }
WOBBLE_LANES Floats4 High(Floats8 pair) { return __builtin_shufflevector(pair, pair, 4, 5, 6, 7); }
WOBBLE_LANES Floats8 Join(Floats4 low, Floats4 high) {
  return __builtin_shufflevector(low, high, 0, 1, 2, 3, 4, 5, 6, 7);
}
WOBBLE_LANES Doubles2 Low(Doubles4 pair) { return __builtin_shufflevector(pair, pair, 0, 1); }
WOBBLE_LANES Doubles2 High(Doubles4 pair) { return __builtin_shufflevector(pair, pair, 2, 3); }
WOBBLE_LANES Doubles4 Join(Doubles2 low, Doubles2 high) { return __builtin_shufflevector(low, high, 0, 1, 2, 3); }

WOBBLE_LANES Floats8 Fma(Floats8 a, Floats8 b, Floats8 c) {
  return Join(Fma(Low(a), Low(b), Low(c)), Fma(High(a), High(b), High(c)));
}
WOBBLE_LANES Floats8 Fms(Floats8 a, Floats8 b, Floats8 c) {
  return Join(Fms(Low(a), Low(b), Low(c)), Fms(High(a), High(b), High(c)));
}
WOBBLE_LANES Floats8 Fnma(Floats8 a, Floats8 b, Floats8 c) {
  return Join(Fnma(Low(a), Low(b), Low(c)), Fnma(High(a), High(b), High(c)));
}
WOBBLE_LANES Floats8 Sqrt(Floats8 a) { return Join(Sqrt(Low(a)), Sqrt(High(a))); }
WOBBLE_LANES Floats8 Max(Floats8 a, Floats8 b) { return Join(Max(Low(a), Low(b)), Max(High(a), High(b))); }
WOBBLE_LANES Floats8 Min(Floats8 a, Floats8 b) { return Join(Min(Low(a), Low(b)), Min(High(a), High(b))); }
WOBBLE_LANES unsigned FindBelow(Floats8 a, Floats8 b) {
  return FindBelow(Low(a), Low(b)) | FindBelow(High(a), High(b)) << 4U;
}
WOBBLE_LANES void Fill(Floats8& lanes, float value) { lanes = Join(vdupq_n_f32(value), vdupq_n_f32(value)); }

WOBBLE_LANES Doubles4 Fma(Doubles4 a, Doubles4 b, Doubles4 c) {
  return Join(Fma(Low(a), Low(b), Low(c)), Fma(High(a), High(b), High(c)));
}
WOBBLE_LANES Doubles4 Fms(Doubles4 a, Doubles4 b, Doubles4 c) {
  return Join(Fms(Low(a), Low(b), Low(c)), Fms(High(a), High(b), High(c)));
}
WOBBLE_LANES Doubles4 Fnma(Doubles4 a, Doubles4 b, Doubles4 c) {
  return Join(Fnma(Low(a), Low(b), Low(c)), Fnma(High(a), High(b), High(c)));
}
WOBBLE_LANES Doubles4 Sqrt(Doubles4 a) { return Join(Sqrt(Low(a)), Sqrt(High(a))); }
WOBBLE_LANES Doubles4 Max(Doubles4 a, Doubles4 b) { return Join(Max(Low(a), Low(b)), Max(High(a), High(b))); }
WOBBLE_LANES Doubles4 Min(Doubles4 a, Doubles4 b) { return Join(Min(Low(a), Low(b)), Min(High(a), High(b))); }
WOBBLE_LANES unsigned FindBelow(Doubles4 a, Doubles4 b) {
  return FindBelow(Low(a), Low(b)) | FindBelow(High(a), High(b)) << 2U;
}
WOBBLE_LANES void Fill(Doubles4& lanes, double value) { lanes = Join(vdupq_n_f64(value), vdupq_n_f64(value)); }

}  // namespace wobble::physics
