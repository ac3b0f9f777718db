// The terms that every sweep has, whatever its lanes are: springs, and the stages of RK4.
#pragma once

#include <cstddef>
#include <cstdint>

#include "server/physics/lanes/lanes.h"

#define WOBBLE_INLINE static inline __attribute__((always_inline))

namespace wobble::physics {
namespace {

template <class V>
struct Vector3Of {
  V x, y, z;
};

// Added to squared lengths or taken as their least, m²: two vertices in one place have no direction, and nothing is
// divided by zero.
inline constexpr float kLeastSquare = 1e-30F;

// l, from the other end of a spring to the own end, m, and rate = l̇·l, m²/s.
template <class V>
struct SpringEnds {
  Vector3Of<V> l;
  V rate;
};

template <class V>
WOBBLE_INLINE SpringEnds<V> FindEnds(const V* own, const V* other) {
  const Vector3Of<V> l{own[0] - other[0], own[1] - other[1], own[2] - other[2]};
  return {l, Fma(l.z, own[5] - other[5], Fma(l.y, own[4] - other[4], l.x * (own[3] - other[3])))};
}

template <class Real, class V>
WOBBLE_INLINE V FindLength(const Vector3Of<V>& l) {
  return Sqrt(Fma(l.z, l.z, Fma(l.y, l.y, Fma(l.x, l.x, Spread<V>(Real(kLeastSquare))))));
}

// k − k r/|l| + c (l̇·l)/|l|²; the spring's force on its own end is −l times that. inverse: 1/|l|. Coefficients of zero
// give 0.
template <class V>
WOBBLE_INLINE V FindTension(V rate, V inverse, V stiffness, V stiffnessAtRest, V damping) {
  return Fma(Fms(damping * rate, inverse, stiffnessAtRest), inverse, stiffness);
}

// The force of a spring on its other end, N.
template <class Real, class V>
WOBBLE_INLINE Vector3Of<V> FindPull(const SpringEnds<V>& ends, V stiffness, V stiffnessAtRest, V damping, V factor) {
  const V inverse = Spread<V>(Real(1)) / FindLength<Real>(ends.l);
  const V tension = factor * FindTension(ends.rate, inverse, stiffness, stiffnessAtRest, damping);
  return {tension * ends.l.x, tension * ends.l.y, tension * ends.l.z};
}

template <class V>
WOBBLE_INLINE V AddSquares(const Vector3Of<V>& a, V sum) {
  return sum + Fma(a.x, a.x, Fma(a.y, a.y, a.z * a.z));
}

// Errors are summed over a body's vertices in this many sums, by the vertex's number modulo it: the order of each sum
// is then the same when lanes are vertices.
inline constexpr std::uint32_t kErrorSums = 16;

template <class V>
WOBBLE_INLINE void Clear(V (&sums)[kErrorSums]) {
  for (V& sum : sums) sum = V{};
}

// Adds the sums up, always in the same pairs. Overwrites them.
template <class V>
WOBBLE_INLINE V AddUp(V* sums) {
  for (std::uint32_t half = kErrorSums / 2; half > 0; half /= 2) {
    for (std::uint32_t i = 0; i < half; ++i) sums[i] = sums[i] + sums[i + half];
  }
  return sums[0];
}

// Stage 0 to 3 of the classic tableau for one vertex: adds the stage's rates to the step's sum and writes the state of
// the next stage; stage 3 writes the end of the step. begin, sum, next: six numbers `stride` apart.
template <int Stage, class V>
WOBBLE_INLINE void Advance(const V* begin, V* sum, V* next, std::size_t stride, const V* own, const Vector3Of<V>& a,
                           V weight, V reach, V& errors) {
  const V rates[6] = {own[3], own[4], own[5], a.x, a.y, a.z};
  if constexpr (Stage == 0) {
    errors = AddSquares<V>({sum[0] - a.x, sum[stride] - a.y, sum[2 * stride] - a.z}, errors);
    for (std::size_t k = 0; k < 6; ++k) sum[k * stride] = weight * rates[k];
  } else if constexpr (Stage < 3) {
    for (std::size_t k = 0; k < 6; ++k) sum[k * stride] = Fma(weight, rates[k], sum[k * stride]);
  }
  if constexpr (Stage < 3) {
    for (std::size_t k = 0; k < 6; ++k) next[k * stride] = Fma(reach, rates[k], begin[k * stride]);
  } else {
    for (std::size_t k = 0; k < 6; ++k) {
      next[k * stride] = begin[k * stride] + Fma(weight, rates[k], sum[k * stride]);
    }
    errors = AddSquares<V>({own[3] - next[3 * stride], own[4] - next[4 * stride], own[5] - next[5 * stride]}, errors);
    sum[0] = a.x;
    sum[stride] = a.y;
    sum[2 * stride] = a.z;
  }
}

}  // namespace
}  // namespace wobble::physics

#undef WOBBLE_INLINE
