// Products and sums of modes for many bodies. Of the basis of a ball of 162 vertices, half a megabyte for each of the
// two, a part that fits the caches serves all bodies before the next part is read.
//
// Everything is a template of the register type: see product_kernel.h.
#pragma once

#include "protocol/codec/encoding/crowd_kernels.h"
#include "protocol/codec/product_kernel.h"

namespace wobble::protocol {

template <class R, std::size_t kRowsAtOnce>
struct ProductLoops {
  using V = typename R::Type;
  using Sum = typename R::Sum;
  static constexpr std::size_t kModesAtOnce = 64;
  static constexpr std::size_t kInts = R::kNumbers / 2;

  template <std::size_t kRows>
  static void FindRest(const ProductTask& task, const ProductRow* rows, std::size_t count) {
    if constexpr (kRows > 0) {
      if (count == kRows) return ProductKernel<R>::template FindRows<kRows>(task, rows);
      FindRest<kRows - 1>(task, rows, count);
    }
  }

  static void FindProducts(const ProductTask& task, const ProductRow* rows, std::size_t count) {
    for (std::size_t mode = 0; mode < task.modeCount; mode += kModesAtOnce) {
      ProductTask part = task;
      part.modes += mode;
      part.modeCount = task.modeCount - mode < kModesAtOnce ? task.modeCount - mode : kModesAtOnce;
      std::size_t row = 0;
      for (; row + kRowsAtOnce <= count; row += kRowsAtOnce) {
        ProductKernel<R>::template FindRows<kRowsAtOnce>(part, rows + row);
      }
      FindRest<kRowsAtOnce - 1>(part, rows + row, count - row);
    }
  }

  // Rows row … row + size − 1, at most kRegisters of them, the last of which may be a part of one.
  template <std::size_t kBodies, std::size_t kRegisters>
  static void FindTile(const SumTask& task, const SumGroup& group, std::size_t first, std::size_t row,
                       std::size_t size) {
    const std::size_t last = size - (kRegisters - 1) * kInts;
    Sum sums[kBodies][kRegisters] = {};
    const std::int16_t* values[kBodies];
    for (std::size_t body = 0; body < kBodies; ++body) values[body] = group.bodies[first + body].values;
    const std::int16_t* const from = task.pairs + 2 * row;
    for (std::size_t i = 0; i < group.usedCount; ++i) {
      const std::size_t pair = group.used[i];
      const std::int16_t* const at = from + 2 * task.rows * pair;
      V modes[kRegisters];
#pragma GCC unroll 8
      for (std::size_t k = 0; k + 1 < kRegisters; ++k) modes[k] = R::Load(at + k * R::kNumbers);
      modes[kRegisters - 1] = R::LoadFirst(at + (kRegisters - 1) * R::kNumbers, 2 * last);
#pragma GCC unroll 8
      for (std::size_t body = 0; body < kBodies; ++body) {
        const V value = R::SpreadPair(values[body] + 2 * pair);
#pragma GCC unroll 8
        for (std::size_t k = 0; k < kRegisters; ++k) sums[body][k] = R::MultiplyAdd(sums[body][k], modes[k], value);
      }
    }
#pragma GCC unroll 8
    for (std::size_t body = 0; body < kBodies; ++body) {
      std::uint32_t* const to = group.bodies[first + body].sums + row;
#pragma GCC unroll 8
      for (std::size_t k = 0; k < kRegisters; ++k) {
        R::StoreFirst(to + k * kInts, sums[body][k], k + 1 < kRegisters ? kInts : last);
      }
    }
  }

  template <std::size_t kBodies>
  static void FindTiles(const SumTask& task, const SumGroup& group, std::size_t first, std::size_t row,
                        std::size_t size) {
    switch ((size + kInts - 1) / kInts) {
      case 1:
        return FindTile<kBodies, 1>(task, group, first, row, size);
      case 2:
        return FindTile<kBodies, 2>(task, group, first, row, size);
      case 3:
        return FindTile<kBodies, 3>(task, group, first, row, size);
      default:
        return FindTile<kBodies, 4>(task, group, first, row, size);
    }
  }

  template <std::size_t kBodies>
  static void FindRestOfTiles(const SumTask& task, const SumGroup& group, std::size_t first, std::size_t row,
                              std::size_t size) {
    if constexpr (kBodies > 0) {
      if (group.count - first == kBodies) return FindTiles<kBodies>(task, group, first, row, size);
      FindRestOfTiles<kBodies - 1>(task, group, first, row, size);
    }
  }

  static void FindSums(const SumTask& task, const SumGroup* groups, std::size_t count) {
    constexpr std::size_t kRows = 4 * kInts;
    for (std::size_t row = 0; row < task.rows; row += kRows) {
      const std::size_t size = task.rows - row < kRows ? task.rows - row : kRows;
      for (std::size_t i = 0; i < count; ++i) {
        std::size_t first = 0;
        for (; first + kRowsAtOnce <= groups[i].count; first += kRowsAtOnce) {
          FindTiles<kRowsAtOnce>(task, groups[i], first, row, size);
        }
        FindRestOfTiles<kRowsAtOnce - 1>(task, groups[i], first, row, size);
      }
    }
  }
};

}  // namespace wobble::protocol
