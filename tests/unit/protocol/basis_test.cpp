// Bases: orthonormal with any number of modes sent, the same bits on every machine, and safe against any bytes.
#include "protocol/codec/basis_reader.h"

#include <gtest/gtest.h>

#include <cmath>

#include "protocol/messages.h"
#include "tests/support/basis_source.h"
#include "tests/unit/damage.h"

namespace wobble::protocol {
namespace {

using test::MakeBasisSource;

void ExpectOrthonormal(const Basis& basis) {
  const std::size_t rows = basis.Rows();
  for (std::size_t a = 0; a < rows; ++a) {
    for (std::size_t b = 0; b <= a; ++b) {
      double product = 0;
      for (std::size_t i = 0; i < rows; ++i) product += double(basis.Column(a)[i]) * basis.Column(b)[i];
      EXPECT_NEAR(product / 16384 / 16384, a == b ? 1 : 0, 1e-3) << a << " " << b;
    }
  }
}

TEST(Basis, IsOrthonormalHoweverFewModesAreSent) {
  for (const auto kind : {BasisSource::Kind::kFull, BasisSource::Kind::kScalar, BasisSource::Kind::kCosine}) {
    for (const std::size_t modes : {0U, 1U, 7U, 11U}) {
      for (const std::uint8_t blocks : {std::uint8_t{0}, std::uint8_t{3}}) {
        if (kind != BasisSource::Kind::kFull && blocks > 0) continue;
        const auto basis = ReadBasis(WriteBasis(MakeBasisSource(kind, 12, modes, blocks)), 12);
        ASSERT_NE(basis, nullptr) << modes;
        EXPECT_EQ(basis->columns.size(), basis->Rows() * basis->Rows());
        EXPECT_EQ(basis->levels.at(35), 150 - kLevelZero);
        EXPECT_EQ(basis->gains.at(35), -3);
        ExpectOrthonormal(*basis);
      }
    }
  }
}

TEST(Basis, BeginsWithTheModesThatWereSent) {
  const BasisSource source = MakeBasisSource(BasisSource::Kind::kFull, 12, 1, 0);
  const auto basis = ReadBasis(WriteBasis(source), 12);
  double square = 0;
  for (const std::int8_t entry : source.modes) square += double(entry) * entry;
  for (std::size_t i = 0; i < 36; ++i) {
    EXPECT_NEAR(basis->Column(0)[i], 16384 * source.modes[i] / std::sqrt(square), 0.51);
  }
}

// As a ball's of 162 vertices; the client completes it a few steps at a time.
TEST(Basis, IsCompletedInSmallStepsToTheSameBits) {
  for (const std::uint8_t blocks : {std::uint8_t{0}, std::uint8_t{8}}) {
    const auto bytes = WriteBasis(MakeBasisSource(BasisSource::Kind::kFull, 162, 60, blocks));
    BasisReader reader(bytes, 162);
    std::size_t steps = 0, most = 0;
    for (std::size_t work = reader.Step(); work > 0; work = reader.Step()) {
      most = std::max(most, work);
      ++steps;
    }
    EXPECT_GT(steps, 1000U);
    EXPECT_LT(most, 70'000U);
    const auto basis = reader.Take(), atOnce = ReadBasis(bytes, 162);
    ASSERT_NE(basis, nullptr);
    EXPECT_EQ(basis->columns, atOnce->columns);
  }
}

// A change here is a change of the format: raise kProtocolVersion and mend STANDARD.md.
TEST(Basis, GoldenHash) {
  const auto hash = [](BasisSource::Kind kind, std::uint8_t blocks) {
    const auto basis = ReadBasis(WriteBasis(MakeBasisSource(kind, 48, 9, blocks)), 48);
    EXPECT_NE(basis, nullptr);
    if (basis == nullptr) return std::uint64_t{0};
    return HashBytes({reinterpret_cast<const std::uint8_t*>(basis->columns.data()), 2 * basis->columns.size()});
  };
  EXPECT_EQ(hash(BasisSource::Kind::kFull, 3), 13129719048511850325U);
  EXPECT_EQ(hash(BasisSource::Kind::kScalar, 0), 15819824211143669474U);
  EXPECT_EQ(hash(BasisSource::Kind::kCosine, 0), 10052701850387350773U);
}

TEST(Basis, EveryTruncationIsRefused) {
  for (const auto kind : {BasisSource::Kind::kFull, BasisSource::Kind::kScalar, BasisSource::Kind::kCosine}) {
    const auto bytes = WriteBasis(MakeBasisSource(kind, 12, 3, kind == BasisSource::Kind::kFull ? 2 : 0));
    test::ForEachTruncation(bytes, [](std::span<const std::uint8_t> cut) { EXPECT_EQ(ReadBasis(cut, 12), nullptr); });
    auto longer = bytes;
    longer.push_back(0);
    EXPECT_EQ(ReadBasis(longer, 12), nullptr);
    EXPECT_EQ(ReadBasis(bytes, 13), nullptr) << "of another body";
  }
}

TEST(Basis, EveryChangedByteIsSafe) {
  for (const auto kind : {BasisSource::Kind::kFull, BasisSource::Kind::kScalar, BasisSource::Kind::kCosine}) {
    const auto bytes = WriteBasis(MakeBasisSource(kind, 6, 2, kind == BasisSource::Kind::kFull ? 2 : 0));
    test::ForEachChangedByte(bytes, [](std::span<const std::uint8_t> changed) {
      const auto basis = ReadBasis(changed, 6);
      if (basis == nullptr) return;
      EXPECT_EQ(basis->columns.size(), basis->Rows() * basis->Rows());
    });
  }
}

TEST(Basis, WhatSpansNothingIsRefused) {
  BasisSource source = MakeBasisSource(BasisSource::Kind::kFull, 12, 2, 0);
  std::fill(source.modes.begin() + 36, source.modes.end(), std::int8_t{0});
  EXPECT_EQ(ReadBasis(WriteBasis(source), 12), nullptr) << "a mode of zeros";
  std::copy_n(source.modes.begin(), 36, source.modes.begin() + 36);
  EXPECT_EQ(ReadBasis(WriteBasis(source), 12), nullptr) << "the same mode twice";
  source = MakeBasisSource(BasisSource::Kind::kFull, 12, 2, 1);
  std::fill(source.turns.begin(), source.turns.end(), std::int8_t{1});
  EXPECT_EQ(ReadBasis(WriteBasis(source), 12), nullptr) << "a matrix of rank 1";
  source = MakeBasisSource(BasisSource::Kind::kFull, 12, 2, 0);
  source.order[3] = source.order[4];
  EXPECT_EQ(ReadBasis(WriteBasis(source), 12), nullptr) << "no permutation";
  const std::size_t many = kMaxTrainedVertices + 2;
  EXPECT_EQ(ReadBasis(WriteBasis(MakeBasisSource(BasisSource::Kind::kFull, many, 1, 0)), many), nullptr);
}

}  // namespace
}  // namespace wobble::protocol
