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

// What a spring pulls with at its other end, −[k − k r/|l| + c (l̇·l)/|l|²] l being its force on its own. A spring
// without coefficients gives 0.
template <class V, class Real>
WOBBLE_INLINE Vector3Of<V> FindPull(const V* own, const V* other, V stiffness, V stiffnessAtRest, V damping, V factor) {
  const V lx = own[0] - other[0];
  const V ly = own[1] - other[1];
  const V lz = own[2] - other[2];
  const V square = Max(Fma(lz, lz, Fma(ly, ly, lx * lx)), Spread<V>(Real(kLeastSquare)));
  const V rate = Fma(lz, own[5] - other[5], Fma(ly, own[4] - other[4], lx * (own[3] - other[3])));
  const V inverse = Spread<V>(Real(1)) / Sqrt(square);
  const V damped = Fma(damping * rate, inverse, -stiffnessAtRest);
  const V tension = factor * Fma(damped, inverse, stiffness);
  return {tension * lx, tension * ly, tension * lz};
}

// Stage 0 … 3 of the classic tableau: what it adds to the step, and where the next stage stands. The last one completes
// the step. begin, sum, next: of the vertex, six numbers `stride` apart.
template <int Stage, class V>
WOBBLE_INLINE void Advance(const V* begin, V* sum, V* next, std::size_t stride, const V* own, const Vector3Of<V>& a,
                           V weight, V reach, V& errors) {
  const V rates[6] = {own[3], own[4], own[5], a.x, a.y, a.z};
  if constexpr (Stage == 0) {
    const V jumpX = sum[0] - a.x;
    const V jumpY = sum[stride] - a.y;
    const V jumpZ = sum[2 * stride] - a.z;
    errors = Fma(jumpX, jumpX, Fma(jumpY, jumpY, Fma(jumpZ, jumpZ, errors)));
    for (std::size_t k = 0; k < 6; ++k) sum[k * stride] = weight * rates[k];
  } else if constexpr (Stage < 3) {
    for (std::size_t k = 0; k < 6; ++k) sum[k * stride] = Fma(weight, rates[k], sum[k * stride]);
  }
  if constexpr (Stage < 3) {
    for (std::size_t k = 0; k < 6; ++k) next[k * stride] = Fma(reach, rates[k], begin[k * stride]);
  } else {
    for (std::size_t k = 0; k < 6; ++k) {
      const V arrived = begin[k * stride] + Fma(weight, rates[k], sum[k * stride]);
      if (k >= 3) {
        const V error = own[k] - arrived;
        errors = Fma(error, error, errors);
      }
      next[k * stride] = arrived;
    }
    sum[0] = a.x;
    sum[stride] = a.y;
    sum[2 * stride] = a.z;
  }
}

}  // namespace
}  // namespace wobble::physics

#undef WOBBLE_INLINE
