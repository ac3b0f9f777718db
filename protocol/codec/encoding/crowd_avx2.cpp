// The kernels of AVX2, the program's baseline.
#include "protocol/codec/encoding/crowd_kernels.h"
#include "protocol/codec/encoding/product_loops.h"
#include "protocol/codec/encoding/rounding_lanes.h"

namespace wobble::protocol {
namespace {

struct Lanes256 {
  static constexpr std::size_t kLanes = 8;
  typedef float Floats __attribute__((vector_size(32)));
  typedef std::int32_t Ints __attribute__((vector_size(32)));
  typedef std::uint32_t Unsigneds __attribute__((vector_size(32)));
  struct Doubles {
    __m256d low = {}, high = {};
    [[nodiscard]] double Read(std::size_t lane) const { return lane < 4 ? low[lane] : high[lane - 4]; }
  };

  static Floats GatherFloats(const float* table, Ints at) { return _mm256_i32gather_ps(table, (__m256i)at, 4); }
  static Ints WidenBytes(const std::int8_t* from) {
    return (Ints)_mm256_cvtepi8_epi32(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(from)));
  }
  static Ints RoundToInts(Floats x) { return (Ints)_mm256_cvtps_epi32(x); }
  static Floats ToFloats(Ints x) { return _mm256_cvtepi32_ps((__m256i)x); }
  static void AddDoubles(Floats x, Doubles& sums) {
    sums.low += _mm256_cvtps_pd(_mm256_castps256_ps128(x));
    sums.high += _mm256_cvtps_pd(_mm256_extractf128_ps(x, 1));
  }
  template <class V>
  static void Interleave(V a, V b, V* both) {
    both[0] = __builtin_shufflevector(a, b, 0, 8, 1, 9, 2, 10, 3, 11);
    both[1] = __builtin_shufflevector(a, b, 4, 12, 5, 13, 6, 14, 7, 15);
  }
  static bool IsAny(Ints mask) { return _mm256_testz_si256((__m256i)mask, (__m256i)mask) == 0; }
};

void RoundLanes256(const RoundingLanes& task, RoundingLane* lanes, std::size_t count) {
  for (; count > 8; lanes += 16, count -= count < 16 ? count : 16) {
    RoundingLoop<Lanes256, 2>::Round(task, lanes, count < 16 ? count : 16);
  }
  if (count > 0) RoundingLoop<Lanes256, 1>::Round(task, lanes, count);
}

}  // namespace

CrowdKernels MakeCrowdKernels256() {
  using Loops = ProductLoops<Registers256, 3>;
  return {&Loops::FindProducts, &Loops::FindSums, &RoundLanes256};
}

}  // namespace wobble::protocol
