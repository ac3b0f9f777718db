// The terms of every sweep, whatever its lanes are.
#pragma once

#include <cstddef>

#include "server/physics/lanes/lanes.h"

#define WOBBLE_INLINE static inline __attribute__((always_inline))

namespace wobble::physics {
namespace {

template <class V>
struct Vector3Of {
  V x, y, z;
};

// Below this two vertices are in one place: there is no direction to push in. m².
inline constexpr float kLeastSquare = 1e-30F;

// What a spring pulls with at its other end, −[k − k r/|l| + c (l̇·l)/|l|²] l being its force on its own. l: from the
// other end to the own, m; rate: l̇·l. A spring without coefficients gives 0.
template <class Real, class V>
WOBBLE_INLINE Vector3Of<V> FindPull(const Vector3Of<V>& l, V rate, V stiffness, V stiffnessAtRest, V damping,
                                    V factor) {
  const V square = Max(Fma(l.z, l.z, Fma(l.y, l.y, l.x * l.x)), Spread<V>(Real(kLeastSquare)));
  const V inverse = Spread<V>(Real(1)) / Sqrt(square);
  const V damped = Fms(damping * rate, inverse, stiffnessAtRest);
  const V tension = factor * Fma(damped, inverse, stiffness);
  return {tension * l.x, tension * l.y, tension * l.z};
}

template <class V>
WOBBLE_INLINE V AddSquares(const Vector3Of<V>& a, V sum) {
  return sum + Fma(a.x, a.x, Fma(a.y, a.y, a.z * a.z));
}

// Stage 0 … 3 of the classic tableau: what it adds to the step, and where the next stage stands. The last one completes
// the step. begin, sum, next: of the vertex, six numbers `stride` apart.
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
