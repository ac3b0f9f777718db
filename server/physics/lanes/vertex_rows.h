// A vertex in a register, a row: x y z and one more number, for the sweep of a lone body. Four or eight rows can be
// transposed into vectors with a lane for each vertex, and back. How many they are is the same on all processors:
// RowsOf<float>::Lanes is two rows, RowsOf<double>::Lanes is one.
#pragma once

#include "server/physics/lanes/lanes.h"

#define WOBBLE_INLINE static inline __attribute__((always_inline))

namespace wobble::physics {

template <class Real>
struct RowsOf;

}  // namespace wobble::physics

#if defined(__aarch64__)
#include "server/physics/lanes/vertex_rows_neon.h"
#else
#include "server/physics/lanes/vertex_rows_avx.h"
#endif

#undef WOBBLE_INLINE
