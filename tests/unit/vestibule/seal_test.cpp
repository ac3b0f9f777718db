// Sealed datagrams: opened once, by who has the key, and never when a bit of them has changed.
#include "protocol/transport/vestibule/seal.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/unit/vestibule/deterministic.h"

namespace wobble::transport::vestibule {
namespace {

class SealTest : public testing::Test {
 protected:
  SealTest() {
    EXPECT_TRUE(InitialiseSodium());
    MakeRandom(5)(key);
    sealer = Sealer(key);
    opener = Opener(key);
  }
  Bytes Seal(const Bytes& words) {
    Bytes datagram;
    const std::span<const std::uint8_t> part = words;
    sealer.Seal(SealedKind::kData, 0x123456, {&part, 1}, datagram);
    return datagram;
  }
  bool Open(const Bytes& datagram) { return opener.Open(datagram, plain); }

  Key key{};
  Sealer sealer;
  Opener opener;
  Bytes plain;
};

TEST_F(SealTest, OpensWhatWasSealedAndShowsNothingOfIt) {
  const Bytes secret(64, 'A');
  const Bytes datagram = Seal(secret);
  EXPECT_EQ(datagram.size(), secret.size() + kSealedOverhead);
  EXPECT_EQ(ReadSession(datagram), 0x123456U);
  EXPECT_EQ(std::search(datagram.begin(), datagram.end(), secret.begin(), secret.begin() + 4), datagram.end());
  ASSERT_TRUE(Open(datagram));
  EXPECT_EQ(plain, secret);
  ASSERT_TRUE(Open(Seal({}))) << "nothing is a message, too";
  EXPECT_TRUE(plain.empty());
}

TEST_F(SealTest, PartsAreOneMessage) {
  const Bytes a{1, 2}, b{3};
  const std::span<const std::uint8_t> parts[] = {a, {}, b};
  Bytes datagram;
  sealer.Seal(SealedKind::kData, 1, parts, datagram);
  ASSERT_TRUE(Open(datagram));
  EXPECT_EQ(plain, (Bytes{1, 2, 3}));
}

TEST_F(SealTest, NoBitMayChangeAndNoByteBeCut) {
  const Bytes datagram = Seal({1, 2, 3, 4, 5});
  for (std::size_t bit = 0; bit < 8 * datagram.size(); ++bit) {
    Bytes changed = datagram;
    changed[bit / 8] ^= static_cast<std::uint8_t>(1U << bit % 8);
    EXPECT_FALSE(Open(changed)) << "bit " << bit;
  }
  for (std::size_t size = 0; size < datagram.size(); ++size)
    EXPECT_FALSE(Open({datagram.begin(), datagram.begin() + static_cast<std::ptrdiff_t>(size)}));
  EXPECT_TRUE(Open(datagram)) << "nothing of that has spent it";
}

TEST_F(SealTest, AnotherKeyOpensNothing) {
  Key other{};
  Opener stranger(other);
  EXPECT_FALSE(stranger.Open(Seal({1}), plain));
}

TEST_F(SealTest, TakesEachOnceInAnyOrderWithinTheWindow) {
  std::vector<Bytes> datagrams;
  for (std::uint8_t i = 0; i < 200; ++i) datagrams.push_back(Seal({i}));
  std::shuffle(datagrams.begin(), datagrams.end(), std::mt19937(3));
  for (const Bytes& datagram : datagrams) EXPECT_TRUE(Open(datagram));
  for (const Bytes& datagram : datagrams) EXPECT_FALSE(Open(datagram));
}

TEST_F(SealTest, TakesNothingFromBehindTheWindow) {
  std::vector<Bytes> datagrams;
  for (std::size_t i = 0; i <= Opener::kWindow + 1; ++i) datagrams.push_back(Seal({1}));
  EXPECT_TRUE(Open(datagrams.back()));
  EXPECT_FALSE(Open(datagrams[0]));
  EXPECT_FALSE(Open(datagrams[1])) << "just behind it";
  EXPECT_TRUE(Open(datagrams[2])) << "its oldest";
  EXPECT_FALSE(Open(datagrams[2]));
}

// The low half of the number wraps after four billion datagrams; a leap of more than the window forgets the places of
// all that lies between.
TEST_F(SealTest, LongLeapsAndTheWrapOfTheLowHalfAreFollowed) {
  Bytes datagram;
  for (int i = 0; i < 3000; ++i) datagram = Seal({1});
  EXPECT_TRUE(Open(datagram));
  EXPECT_FALSE(Open(datagram));
  for (int i = 0; i < 3000; ++i) datagram = Seal({2});
  EXPECT_TRUE(Open(datagram));
}

}  // namespace
}  // namespace wobble::transport::vestibule
