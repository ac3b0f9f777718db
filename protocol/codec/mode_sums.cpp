// Two modes at a time: AVX2 multiplies pairs of int16 and adds the two products in one instruction, where one mode at a
// time takes a widening, a multiplication of 32 bits and a load and store of the sums. A tile of 64 rows stays in eight
// registers while all modes pass. Values beyond int16 (a body far out of shape at a fine step) go one at a time.
#include "protocol/codec/mode_sums.h"

#include <cassert>
#include <cstring>

#ifdef __AVX2__
#include <immintrin.h>
#endif

namespace wobble::protocol {
namespace {

bool IsShort(std::uint32_t value) {
  const auto number = static_cast<std::int32_t>(value);
  return number == static_cast<std::int16_t>(number);
}

void AddMode(std::span<const std::int16_t> column, std::uint32_t value, std::uint32_t* sums) {
  for (std::size_t i = 0; i < column.size(); ++i) {
    sums[i] += value * static_cast<std::uint32_t>(std::int32_t{column[i]});
  }
}

}  // namespace

void AddModesPlainly(const Basis& basis, std::span<const std::uint32_t> values, std::uint32_t* sums) {
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (values[k] != 0) AddMode(basis.Column(k), values[k], sums);
  }
}

void ModeSums::Add(const Basis& basis, std::span<const std::uint32_t> values, std::uint32_t* sums) {
  assert(values.size() == basis.Rows());
  m_terms.clear();
  for (std::size_t k = 0; k < values.size(); k += 2) {
    const std::uint32_t first = values[k], second = k + 1 < values.size() ? values[k + 1] : 0;
    if ((first | second) == 0) continue;
    if (IsShort(first) && IsShort(second)) {
      m_terms.push_back({.pair = basis.Pair(k / 2).data(),
                         .values = {static_cast<std::int16_t>(first), static_cast<std::int16_t>(second)}});
      continue;
    }
    AddMode(basis.Column(k), first, sums);
    if (second != 0) AddMode(basis.Column(k + 1), second, sums);
  }
  AddTerms(basis.Rows(), sums);
}

#ifdef __AVX2__

namespace {

constexpr std::size_t kRowsOfRegister = 8;
// A type of its own: g++ 12 stores sums of an intrinsic's type to memory in every round.
typedef std::int32_t Sums __attribute__((vector_size(32)));

template <std::size_t kRegisters, class Term>
void AddTile(std::span<const Term> terms, std::size_t row, std::uint32_t* sums) {
  Sums tile[kRegisters];
  auto* const at = reinterpret_cast<__m256i*>(sums + row);
  for (std::size_t i = 0; i < kRegisters; ++i) tile[i] = (Sums)_mm256_loadu_si256(at + i);
  for (const Term& term : terms) {
    std::int32_t both;
    std::memcpy(&both, term.values, sizeof both);
    const __m256i values = _mm256_set1_epi32(both);
    const auto* const from = reinterpret_cast<const __m256i*>(term.pair + 2 * row);
    for (std::size_t i = 0; i < kRegisters; ++i) {
      const __m256i products = _mm256_madd_epi16(_mm256_loadu_si256(from + i), values);
      tile[i] = (Sums)_mm256_add_epi32((__m256i)tile[i], products);
    }
  }
  for (std::size_t i = 0; i < kRegisters; ++i) _mm256_storeu_si256(at + i, (__m256i)tile[i]);
}

}  // namespace

void ModeSums::AddTerms(std::size_t rows, std::uint32_t* sums) const {
  const std::span<const Term> terms = m_terms;
  std::size_t row = 0;
  for (; row + 8 * kRowsOfRegister <= rows; row += 8 * kRowsOfRegister) AddTile<8>(terms, row, sums);
  for (; row + kRowsOfRegister <= rows; row += kRowsOfRegister) AddTile<1>(terms, row, sums);
  for (const Term& term : terms) {
    for (std::size_t i = row; i < rows; ++i) {
      sums[i] += static_cast<std::uint32_t>(term.values[0] * term.pair[2 * i]) +
                 static_cast<std::uint32_t>(term.values[1] * term.pair[2 * i + 1]);
    }
  }
}

#else

void ModeSums::AddTerms(std::size_t rows, std::uint32_t* sums) const {
  for (const Term& term : m_terms) {
    for (std::size_t i = 0; i < rows; ++i) {
      sums[i] += static_cast<std::uint32_t>(term.values[0] * term.pair[2 * i]) +
                 static_cast<std::uint32_t>(term.values[1] * term.pair[2 * i + 1]);
    }
  }
}

#endif

}  // namespace wobble::protocol
