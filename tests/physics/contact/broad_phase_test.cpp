#include "server/physics/contact/broad_phase.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace wobble::physics {
namespace {

std::vector<IndexPair> FindAllPairs(const std::vector<Box>& boxes) {
  std::vector<IndexPair> pairs;
  for (std::uint32_t i = 0; i < boxes.size(); ++i) {
    for (std::uint32_t j = i + 1; j < boxes.size(); ++j) {
      const bool apart =
          (boxes[i].low.array() > boxes[j].high.array()).any() || (boxes[j].low.array() > boxes[i].high.array()).any();
      if (!apart) pairs.push_back({i, j});
    }
  }
  return pairs;
}

std::vector<Box> MakeBoxes(unsigned seed, std::size_t count, double spread, double largest) {
  std::mt19937 random(seed);
  const auto draw = [&random](double limit) { return limit * (static_cast<double>(random()) / 2147483648.0 - 1); };
  std::vector<Box> boxes;
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3d middle(draw(spread), draw(spread), draw(spread / 4));
    const Vector3d half = Vector3d(draw(largest), draw(largest), draw(largest)).cwiseAbs();
    boxes.push_back({middle - half, middle + half});
  }
  return boxes;
}

class BroadPhaseOfBoxes : public testing::TestWithParam<unsigned> {};

TEST_P(BroadPhaseOfBoxes, FindsWhatComparingAllFinds) {
  std::vector<Box> boxes = MakeBoxes(GetParam(), 300, 12, 1);
  BroadPhase broadPhase;
  const auto found = broadPhase.FindOverlaps(boxes);
  const std::vector<IndexPair> pairs(found.begin(), found.end());
  EXPECT_EQ(pairs, FindAllPairs(boxes));
  EXPECT_GT(pairs.size(), 50U);
}

// A few large boxes among many small ones, some far from the origin, and some that no cell can hold.
TEST_P(BroadPhaseOfBoxes, FindsThemWhateverTheirSizesAndPlaces) {
  std::vector<Box> boxes = MakeBoxes(GetParam(), 200, 10, 0.5);
  const std::vector<Box> large = MakeBoxes(GetParam() + 100, 3, 10, 30);
  boxes.insert(boxes.end(), large.begin(), large.end());
  for (std::size_t i = 0; i < 20; ++i) {
    boxes[i].low.x() += 1e9;
    boxes[i].high.x() += 1e9;
  }
  BroadPhase broadPhase;
  const auto found = broadPhase.FindOverlaps(boxes);
  const std::vector<IndexPair> pairs(found.begin(), found.end());
  EXPECT_EQ(pairs, FindAllPairs(boxes));
}

INSTANTIATE_TEST_SUITE_P(Seeds, BroadPhaseOfBoxes, testing::Values(1U, 2U, 3U, 4U));

TEST(Islands, AreWhatPairsConnect) {
  const std::vector<IndexPair> pairs{{1, 4}, {2, 3}, {4, 6}};
  Islands islands;
  islands.Find(std::vector<std::uint32_t>{0, 1, 2, 3, 4, 5, 6}, pairs);
  ASSERT_EQ(islands.Count(), 4U);
  const auto membersOf = [&islands](std::size_t island) {
    const auto members = islands.MembersOf(island);
    return std::vector<std::uint32_t>(members.begin(), members.end());
  };
  EXPECT_EQ(membersOf(0), (std::vector<std::uint32_t>{0}));
  EXPECT_EQ(membersOf(1), (std::vector<std::uint32_t>{1, 4, 6}));
  EXPECT_EQ(membersOf(2), (std::vector<std::uint32_t>{2, 3}));
  EXPECT_EQ(membersOf(3), (std::vector<std::uint32_t>{5}));
}

TEST(Islands, OfNobodyAreNone) {
  Islands islands;
  islands.Find({}, {});
  EXPECT_EQ(islands.Count(), 0U);
}

}  // namespace
}  // namespace wobble::physics
