// Arithmetic on vectors of W numbers, the same bits in every lane whatever W is. A lane is a body, a spring, a contact
// or a column of a grid, as each kernel says.
//
// Compiler vector types and, where they have no operator, one intrinsic (lanes_avx.h, lanes_neon.h). Rejected: Highway,
// measured on the sweep of sweep.h (162-vertex ball, g++ 12, AMD EPYC with AVX-512): vector types took 12.1 and Highway
// 12.5 ns a vertex and step at W = 16, 17.6 and 18.4 at W = 8; and vector types need no wrapper round + − × ÷, so the
// sweep reads like the formula.
//
// Only operations that every instruction set rounds correctly: sums, products, quotients, square roots and fused
// multiply-adds. So results do not depend on the instruction set. Estimates such as rsqrtps are left out: their bits
// differ between vendors.
#pragma once

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

}  // namespace wobble::physics

#if defined(__aarch64__)
#include "server/physics/lanes/lanes_neon.h"
#else
#include "server/physics/lanes/lanes_avx.h"
#endif

namespace wobble::physics {

template <class V, class Real>
WOBBLE_LANES V Spread(Real value) {
  V lanes;
  Fill(lanes, value);
  return lanes;
}

}  // namespace wobble::physics

#undef WOBBLE_LANES
