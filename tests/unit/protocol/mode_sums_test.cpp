// The sums of modes in pairs against those of one mode at a time.
#include "protocol/codec/mode_sums.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "protocol/codec/basis_reader.h"
#include "tests/support/basis_source.h"

namespace wobble::protocol {
namespace {

// Rows that are odd, fewer than a register, more than a tile, and a rest of each.
TEST(ModeSums, HaveTheBitsOfPlainSums) {
  std::mt19937 random(3);
  ModeSums fast;
  for (const std::size_t vertices : {1U, 2U, 3U, 23U, 43U, 162U}) {
    for (const auto kind : {BasisSource::Kind::kFull, BasisSource::Kind::kScalar}) {
      const std::size_t modes = vertices > 7 ? 5 : 0;
      const auto basis = ReadBasis(WriteBasis(test::MakeBasisSource(kind, vertices, modes, 0)), vertices);
      ASSERT_NE(basis, nullptr) << vertices;
      for (const std::uint32_t size : {0U, 3U, 30'000U, 40'000U, 0x7FFFFFFFU}) {
        std::vector<std::uint32_t> values(basis->Rows());
        for (std::uint32_t& value : values) {
          const bool isZero = random() % 2 == 0;
          value = isZero || size == 0 ? 0 : static_cast<std::uint32_t>(random() % (2 * std::uint64_t{size})) - size;
        }
        std::vector<std::uint32_t> sums(basis->Rows(), 77), plain(basis->Rows(), 77);
        fast.Add(*basis, values, sums.data());
        AddModesPlainly(*basis, values, plain.data());
        EXPECT_EQ(sums, plain) << vertices << " vertices, values to " << size;
      }
    }
  }
}

// The largest products: -32,768 squared, twice, wraps as it does in 32 bits.
TEST(ModeSums, WrapAsPlainSumsDo) {
  Basis basis;
  basis.vertices = 3;  // 9 rows
  basis.columns.assign(81, -32768);
  basis.pairs.assign(90, -32768);
  for (std::size_t i = 0; i < 9; ++i) basis.pairs[2 * (4 * 9 + i) + 1] = 0;  // the ninth mode has no neighbour
  const std::vector<std::uint32_t> values(9, static_cast<std::uint32_t>(-32768));
  std::vector<std::uint32_t> sums(9, 0), plain(9, 0);
  ModeSums().Add(basis, values, sums.data());
  AddModesPlainly(basis, values, plain.data());
  EXPECT_EQ(sums, plain);
}

}  // namespace
}  // namespace wobble::protocol
