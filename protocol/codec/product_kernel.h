// The inner loop of mode_products.h for one instruction set: a tile of four modes and a few rows of numbers. Each
// number of the basis that is loaded serves all rows, and each load of numbers serves four modes.
//
// Everything here is static or a template of the register type, so that no code compiled for a wider instruction set
// can be taken for that of the baseline.
#pragma once

#ifdef __aarch64__
#include <arm_neon.h>
#else
#include <immintrin.h>
#endif

#include <cstddef>
#include <cstdint>

#include "protocol/codec/mode_products.h"
#include "protocol/limits.h"

namespace wobble::protocol {

using FourProducts = std::uint32_t __attribute__((vector_size(16)));

// Registers: Type of numbers, Sum of 32-bit sums (a type of its own: g++ 12 keeps sums in registers from round to round
// only where no intrinsic's type comes between), kNumbers of a register, Load, LoadFirst (the pairs in `count` numbers,
// and zeros), StoreFirst (`count` sums), SpreadPair, MultiplyAdd (pairs of products, added), AddUp (the four sums of
// four registers). NarrowRegisters: those that every processor has that runs the program.
#ifdef __aarch64__
struct NarrowRegisters {
  using Type = int16x8_t;
  using Sum = int32x4_t;
  static constexpr std::size_t kNumbers = 8;
  static Type Load(const std::int16_t* at) { return vld1q_s16(at); }
  static Type LoadFirst(const std::int16_t* at, std::size_t count) {
    std::int16_t padded[kNumbers] = {};
    for (std::size_t i = 0; i + 1 < count; i += 2) padded[i] = at[i], padded[i + 1] = at[i + 1];
    return Load(padded);
  }
  static void StoreFirst(std::uint32_t* at, Sum sums, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) at[i] = static_cast<std::uint32_t>(sums[i]);
  }
  static Type SpreadPair(const std::int16_t* pair) {
    std::int32_t both;
    __builtin_memcpy(&both, pair, sizeof both);
    return vreinterpretq_s16_s32(vdupq_n_s32(both));
  }
  static Sum MultiplyAdd(Sum sum, Type a, Type b) {
    const Sum low = vmull_s16(vget_low_s16(a), vget_low_s16(b));
    return vaddq_s32(sum, vpaddq_s32(low, vmull_high_s16(a, b)));
  }
  static FourProducts AddUp(Sum a, Sum b, Sum c, Sum d) {
    return (FourProducts)vpaddq_s32(vpaddq_s32(a, b), vpaddq_s32(c, d));
  }
};
#else
struct NarrowRegisters {
  using Type = __m256i;
  typedef std::int32_t Sum __attribute__((vector_size(32)));
  static constexpr std::size_t kNumbers = 16;
  static Type Load(const std::int16_t* at) { return _mm256_loadu_si256(reinterpret_cast<const __m256i*>(at)); }
  static Type FindMask(std::size_t count) {
    return _mm256_cmpgt_epi32(_mm256_set1_epi32(static_cast<int>(count)), _mm256_setr_epi32(0, 1, 2, 3, 4, 5, 6, 7));
  }
  static Type LoadFirst(const std::int16_t* at, std::size_t count) {
    return _mm256_maskload_epi32(reinterpret_cast<const int*>(at), FindMask(count / 2));
  }
  static void StoreFirst(std::uint32_t* at, Sum sums, std::size_t count) {
    _mm256_maskstore_epi32(reinterpret_cast<int*>(at), FindMask(count), (__m256i)sums);
  }
  static Type SpreadPair(const std::int16_t* pair) {
    int both;
    __builtin_memcpy(&both, pair, sizeof both);
    return _mm256_set1_epi32(both);
  }
  static Sum MultiplyAdd(Sum sum, Type a, Type b) {
    return (Sum)_mm256_add_epi32((__m256i)sum, _mm256_madd_epi16(a, b));
  }
  static FourProducts AddUp(Sum a, Sum b, Sum c, Sum d) {
    const Type all =
        _mm256_hadd_epi32(_mm256_hadd_epi32((__m256i)a, (__m256i)b), _mm256_hadd_epi32((__m256i)c, (__m256i)d));
    return (FourProducts)_mm_add_epi32(_mm256_castsi256_si128(all), _mm256_extracti128_si256(all, 1));
  }
};
#endif

// What the tiles of some rows of numbers share: the blocks of as many coordinates as a register has in which a row has
// a number other than 0.
struct ProductBlocks {
  std::uint16_t whole[3 * kMaxPatchVertices / NarrowRegisters::kNumbers];  // where they begin
  std::size_t count = 0;
  std::size_t tailBegin = 0, tail = 0;  // the last coordinates, if they are no whole register
};

template <class R>
struct ProductKernel {
  using V = typename R::Type;
  using Sum = typename R::Sum;
  static constexpr std::size_t kModes = 4;

  static bool HasNumbers(const std::int16_t* numbers) {
    std::uint64_t all = 0;
    for (std::size_t i = 0; i < R::kNumbers / 4; ++i) {
      std::uint64_t four;
      __builtin_memcpy(&four, numbers + 4 * i, sizeof four);
      all |= four;
    }
    return all != 0;
  }

  static void FindBlocks(std::size_t size, const ProductRow* rows, std::size_t count, ProductBlocks& blocks) {
    blocks.count = 0;
    for (std::size_t at = 0; at + R::kNumbers <= size; at += R::kNumbers) {
      bool isUsed = false;
      for (std::size_t row = 0; row < count; ++row) isUsed = isUsed || HasNumbers(rows[row].numbers + at);
      blocks.whole[blocks.count] = static_cast<std::uint16_t>(at);
      blocks.count += isUsed ? 1 : 0;
    }
    blocks.tail = size % R::kNumbers;
    blocks.tailBegin = size - blocks.tail;
  }

  // The loops over rows and modes must be unrolled first of all, or the sums are kept in memory.
  template <std::size_t kRows>
  static void AddBlock(Sum (&sums)[kRows][kModes], const V (&columns)[kModes], const ProductRow* rows, std::size_t at) {
#pragma GCC unroll 8
    for (std::size_t row = 0; row < kRows; ++row) {
      const V numbers = R::Load(rows[row].numbers + at);
#pragma GCC unroll 8
      for (std::size_t mode = 0; mode < kModes; ++mode) {
        sums[row][mode] = R::MultiplyAdd(sums[row][mode], numbers, columns[mode]);
      }
    }
  }

  template <std::size_t kRows>
  static void FindTile(const ProductBlocks& blocks, const std::int16_t* const* columns, const ProductRow* rows,
                       FourProducts* products) {
    Sum sums[kRows][kModes] = {};
    for (std::size_t block = 0; block < blocks.count; ++block) {
      const std::size_t at = blocks.whole[block];
      const V modes[kModes] = {R::Load(columns[0] + at), R::Load(columns[1] + at), R::Load(columns[2] + at),
                               R::Load(columns[3] + at)};
      AddBlock<kRows>(sums, modes, rows, at);
    }
    if (blocks.tail > 1) {
      const std::size_t at = blocks.tailBegin;
      const V modes[kModes] = {R::LoadFirst(columns[0] + at, blocks.tail), R::LoadFirst(columns[1] + at, blocks.tail),
                               R::LoadFirst(columns[2] + at, blocks.tail), R::LoadFirst(columns[3] + at, blocks.tail)};
      AddBlock<kRows>(sums, modes, rows, at);
    }
#pragma GCC unroll 8
    for (std::size_t row = 0; row < kRows; ++row) {
      products[row] = R::AddUp(sums[row][0], sums[row][1], sums[row][2], sums[row][3]);
    }
  }

  // Pairs leave the last of an odd number of coordinates out.
  static void Store(const ProductTask& task, const std::uint16_t* modes, std::size_t count, const ProductRow& row,
                    FourProducts products) {
    const bool isOdd = task.size % 2 != 0;
    if (count == kModes && modes[kModes - 1] == modes[0] + kModes - 1 && row.stride == 1 && !isOdd) {
      __builtin_memcpy(row.products + modes[0], &products, sizeof products);
      return;
    }
    std::uint32_t each[kModes];
    __builtin_memcpy(each, &products, sizeof products);
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t last = task.size - 1;
      const int more = isOdd ? task.columns[task.size * modes[i] + last] * row.numbers[last] : 0;
      row.products[modes[i] * row.stride] = static_cast<std::int32_t>(each[i] + static_cast<std::uint32_t>(more));
    }
  }

  // rows: kRows of them.
  template <std::size_t kRows>
  static void FindRows(const ProductTask& task, const ProductRow* rows) {
    ProductBlocks blocks;
    FindBlocks(task.size, rows, kRows, blocks);
    for (std::size_t first = 0; first < task.modeCount; first += kModes) {
      const std::size_t count = task.modeCount - first < kModes ? task.modeCount - first : kModes;
      const std::int16_t* columns[kModes];
      for (std::size_t i = 0; i < kModes; ++i) {
        columns[i] = task.columns + task.size * task.modes[first + (i < count ? i : 0)];
      }
      FourProducts products[kRows];
      FindTile<kRows>(blocks, columns, rows, products);
      for (std::size_t row = 0; row < kRows; ++row) Store(task, task.modes + first, count, rows[row], products[row]);
    }
  }
};

}  // namespace wobble::protocol
