// The bit writer and reader against each other and against bytes derived by hand, and the reader against truncated
// bytes.
#include "protocol/bits.h"

#include <gtest/gtest.h>

#include <random>
#include <utility>

namespace wobble::protocol {
namespace {

using Bytes = std::vector<std::uint8_t>;

TEST(Bits, LeastSignificantBitFirst) {
  Bytes bytes;
  BitWriter writer(bytes);
  writer.Write(0b101, 3);
  writer.Write(0b11, 2);
  writer.Write(0x1FF, 9);
  writer.Align();
  // 0x1FF << 5 | 11 << 3 | 101, low byte first.
  EXPECT_EQ(bytes, (Bytes{0xFD, 0x3F}));
}

TEST(Bits, FieldsOfEveryWidthComeBack) {
  std::mt19937 random(7);
  std::vector<std::pair<std::uint32_t, unsigned>> fields;
  for (unsigned i = 0; i < 5000; ++i) {
    const unsigned count = i % 33;
    const std::uint32_t mask = count == 32 ? 0xFFFFFFFFU : (1U << count) - 1;
    fields.emplace_back(static_cast<std::uint32_t>(random()) & mask, count);
  }
  Bytes bytes;
  BitWriter writer(bytes);
  for (const auto& [value, count] : fields) writer.Write(value, count);
  writer.Align();

  BitReader reader(bytes);
  for (const auto& [value, count] : fields) ASSERT_EQ(reader.Read(count), value) << count << " bits";
  EXPECT_TRUE(reader.AtEnd());
  EXPECT_FALSE(reader.Overran());
}

TEST(Bits, VarintsComeBackInTheirShortestForm) {
  const std::vector<std::pair<std::uint32_t, std::size_t>> cases{
      {0, 1},       {1, 1},       {127, 1},        {128, 2},        {16383, 2},     {16384, 3},
      {2097151, 3}, {2097152, 4}, {0x0FFFFFFF, 4}, {0x10000000, 5}, {0xFFFFFFFF, 5}};
  for (const auto& [value, length] : cases) {
    Bytes bytes;
    BitWriter writer(bytes);
    writer.WriteVarint(value);
    EXPECT_EQ(bytes.size(), length) << value;
    BitReader reader(bytes);
    EXPECT_EQ(reader.ReadVarint(), value);
    EXPECT_FALSE(reader.Overran());
    EXPECT_EQ(reader.ByteOffset(), length);
  }
}

TEST(Bits, VarintsInAnyOtherFormAreRefused) {
  const std::vector<Bytes> refused{
      {},
      {0x80},                                // continues past the end
      {0x80, 0x00},                          // 0 in two bytes
      {0xFF, 0x80, 0x00},                    // 127 in three
      {0xFF, 0xFF, 0xFF, 0xFF, 0x1F},        // over 32 bits
      {0x80, 0x80, 0x80, 0x80, 0x80, 0x01},  // six bytes
  };
  for (const Bytes& bytes : refused) {
    BitReader reader(bytes);
    EXPECT_EQ(reader.ReadVarint(), 0U);
    EXPECT_TRUE(reader.Overran()) << bytes.size() << " bytes";
  }
}

TEST(Bits, PastTheEndThereAreZerosForever) {
  const Bytes bytes{0xFF, 0xFF};
  BitReader reader(bytes);
  EXPECT_EQ(reader.Read(12), 0xFFFU);
  EXPECT_FALSE(reader.Overran());
  EXPECT_EQ(reader.Read(5), 0U);
  EXPECT_TRUE(reader.Overran());
  for (int i = 0; i < 100; ++i) EXPECT_EQ(reader.Read(1), 0U);
  EXPECT_TRUE(reader.Overran());
}

TEST(Bits, EndIsWholeBytesAndZeroFill) {
  const auto endsAfter = [](const Bytes& bytes, unsigned count) {
    BitReader reader(bytes);
    static_cast<void>(reader.Read(count));
    return reader.AtEnd();
  };
  EXPECT_TRUE(endsAfter({0x07}, 3));
  EXPECT_FALSE(endsAfter({0x0F}, 3)) << "a one in the fill";
  EXPECT_FALSE(endsAfter({0x07, 0x00}, 3)) << "a whole byte too many";
  EXPECT_TRUE(endsAfter({0x07, 0x00}, 9));
}

}  // namespace
}  // namespace wobble::protocol
