// The kernels that every processor runs: AVX2 on x86, NEON on ARM.
#include "protocol/codec/encoding/crowd_kernels.h"
#include "protocol/codec/encoding/product_loops.h"
#include "protocol/codec/encoding/rounding_lanes.h"

namespace wobble::protocol {
namespace {

#ifdef __aarch64__
struct NarrowLanes {
  static constexpr std::size_t kLanes = 4;
  typedef float Floats __attribute__((vector_size(16)));
  typedef std::int32_t Ints __attribute__((vector_size(16)));
  typedef std::uint32_t Unsigneds __attribute__((vector_size(16)));
  struct Doubles {
    float64x2_t low = {}, high = {};
    [[nodiscard]] double Read(std::size_t lane) const { return lane < 2 ? low[lane] : high[lane - 2]; }
  };

  static Floats GatherFloats(const float* table, Ints at) {
    return Floats{table[at[0]], table[at[1]], table[at[2]], table[at[3]]};
  }
  static Ints WidenBytes(const std::int8_t* from) { return Ints{from[0], from[1], from[2], from[3]}; }
  static Ints RoundToInts(Floats x) { return vcvtnq_s32_f32(x); }
  static Floats ToFloats(Ints x) { return vcvtq_f32_s32(x); }
  static void AddDoubles(Floats x, Doubles& sums) {
    sums.low += vcvt_f64_f32(vget_low_f32(x));
    sums.high += vcvt_high_f64_f32(x);
  }
  template <class V>
  static void Interleave(V a, V b, V* both) {
    both[0] = __builtin_shufflevector(a, b, 0, 4, 1, 5);
    both[1] = __builtin_shufflevector(a, b, 2, 6, 3, 7);
  }
  static bool IsAny(Ints mask) { return vmaxvq_u32((uint32x4_t)mask) != 0; }
};
#else
struct NarrowLanes {
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
#endif

void RoundNarrowLanes(const RoundingLanes& task, RoundingLane* lanes, std::size_t count) {
  constexpr std::size_t kOne = NarrowLanes::kLanes, kTwo = 2 * kOne;
  for (; count > kOne; lanes += kTwo, count -= count < kTwo ? count : kTwo) {
    RoundingLoop<NarrowLanes, 2>::Round(task, lanes, count < kTwo ? count : kTwo);
  }
  if (count > 0) RoundingLoop<NarrowLanes, 1>::Round(task, lanes, count);
}

}  // namespace

CrowdKernels MakeNarrowCrowdKernels() {
  using Loops = ProductLoops<NarrowRegisters, 3>;
  return {&Loops::FindProducts, &Loops::FindSums, &RoundNarrowLanes};
}

}  // namespace wobble::protocol
