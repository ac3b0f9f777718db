// The kernels of AVX-512, for two translation units: with VNNI, which multiplies and adds in one instruction, and
// without. In an unnamed namespace, so that each has its own.
#pragma once

#include "protocol/codec/encoding/crowd_kernels.h"
#include "protocol/codec/encoding/product_loops.h"
#include "protocol/codec/encoding/rounding_lanes.h"

namespace wobble::protocol {
namespace {

struct Registers512 {
  using Type = __m512i;
  typedef std::int32_t Sum __attribute__((vector_size(64)));
  static constexpr std::size_t kNumbers = 32;
  static __mmask16 FindMask(std::size_t count) { return static_cast<__mmask16>((1U << count) - 1); }
  static Type Load(const std::int16_t* at) { return _mm512_loadu_si512(at); }
  static Type LoadFirst(const std::int16_t* at, std::size_t count) {
    return _mm512_maskz_loadu_epi32(FindMask(count / 2), at);
  }
  static void StoreFirst(std::uint32_t* at, Sum sums, std::size_t count) {
    _mm512_mask_storeu_epi32(at, FindMask(count), (__m512i)sums);
  }
  static Type SpreadPair(const std::int16_t* pair) {
    int both;
    __builtin_memcpy(&both, pair, sizeof both);
    return _mm512_set1_epi32(both);
  }
#ifdef __AVX512VNNI__
  static Sum MultiplyAdd(Sum sum, Type a, Type b) { return (Sum)_mm512_dpwssd_epi32((__m512i)sum, a, b); }
#else
  static Sum MultiplyAdd(Sum sum, Type a, Type b) {
    return (Sum)_mm512_add_epi32((__m512i)sum, _mm512_madd_epi16(a, b));
  }
#endif
  static __m256i AddHalves(Sum sums) {
    return _mm256_add_epi32(_mm512_castsi512_si256((__m512i)sums), _mm512_extracti64x4_epi64((__m512i)sums, 1));
  }
  static FourProducts AddUp(Sum a, Sum b, Sum c, Sum d) {
    const __m256i all =
        _mm256_hadd_epi32(_mm256_hadd_epi32(AddHalves(a), AddHalves(b)), _mm256_hadd_epi32(AddHalves(c), AddHalves(d)));
    return (FourProducts)_mm_add_epi32(_mm256_castsi256_si128(all), _mm256_extracti128_si256(all, 1));
  }
};

struct Lanes512 {
  static constexpr std::size_t kLanes = 16;
  typedef float Floats __attribute__((vector_size(64)));
  typedef std::int32_t Ints __attribute__((vector_size(64)));
  typedef std::uint32_t Unsigneds __attribute__((vector_size(64)));
  struct Doubles {
    __m512d low = {}, high = {};
    [[nodiscard]] double Read(std::size_t lane) const { return lane < 8 ? low[lane] : high[lane - 8]; }
  };

  static Floats GatherFloats(const float* table, Ints at) { return _mm512_i32gather_ps((__m512i)at, table, 4); }
  static Ints WidenBytes(const std::int8_t* from) {
    return (Ints)_mm512_cvtepi8_epi32(_mm_loadu_si128(reinterpret_cast<const __m128i*>(from)));
  }
  static Ints RoundToInts(Floats x) { return (Ints)_mm512_cvtps_epi32(x); }
  static Floats ToFloats(Ints x) { return _mm512_cvtepi32_ps((__m512i)x); }
  static void AddDoubles(Floats x, Doubles& sums) {
    sums.low += _mm512_cvtps_pd(_mm512_castps512_ps256(x));
    sums.high += _mm512_cvtps_pd(_mm512_extractf32x8_ps(x, 1));
  }
  template <class V>
  static void Interleave(V a, V b, V* both) {
    both[0] = __builtin_shufflevector(a, b, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23);
    both[1] = __builtin_shufflevector(a, b, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31);
  }
  static bool IsAny(Ints mask) { return _mm512_test_epi32_mask((__m512i)mask, (__m512i)mask) != 0; }
};

void RoundLanes512(const RoundingLanes& task, RoundingLane* lanes, std::size_t count) {
  if (count > 16) return RoundingLoop<Lanes512, 2>::Round(task, lanes, count);
  RoundingLoop<Lanes512, 1>::Round(task, lanes, count);
}

CrowdKernels MakeWideKernels() {
  using Loops = ProductLoops<Registers512, 6>;
  return {&Loops::FindProducts, &Loops::FindSums, &RoundLanes512};
}

}  // namespace
}  // namespace wobble::protocol
