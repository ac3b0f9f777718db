// Products of modes with rows of numbers: what turns displacements into coefficients, and contact into its prediction.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "protocol/codec/basis.h"

namespace wobble::protocol {

// Numbers of a row, of which the kernels read whole registers.
[[nodiscard]] constexpr std::size_t PadRow(std::size_t size) { return (size + 31) / 32 * 32; }

// One row of numbers, one for each row of the basis, with zeros behind them up to PadRow. The product with mode k comes
// to products[k · stride].
struct ProductRow {
  const std::int16_t* numbers = nullptr;
  std::int32_t* products = nullptr;
  std::size_t stride = 1;
};

// Rows that are taken at a time.
inline constexpr std::size_t kMostProductRows = 6;

struct ProductTask {
  const std::int16_t* columns = nullptr;  // of the basis
  std::size_t size = 0;                   // of a column
  const std::uint16_t* modes = nullptr;   // that are multiplied
  std::size_t modeCount = 0;
};
[[nodiscard]] inline ProductTask MakeProductTask(const Basis& basis, std::span<const std::uint16_t> modes) {
  return {basis.columns.data(), basis.Rows(), modes.data(), modes.size()};
}

// The products of all these modes and rows: exact as long as they fit, else modulo 2^32. Products of other modes stay
// as they are.
void FindProducts(const ProductTask& task, std::span<const ProductRow> rows);
// The same, a mode at a time. FindProducts gives these bits.
void FindProductsPlainly(const ProductTask& task, std::span<const ProductRow> rows);

}  // namespace wobble::protocol
