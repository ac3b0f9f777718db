// RestingBoxes and the roster of awake bodies against a look at every box.
#include "server/physics/contact/resting_boxes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <map>
#include <random>

#include "server/physics/roster.h"

namespace wobble::physics {
namespace {

class Draw {
 public:
  explicit Draw(unsigned seed) : m_random(seed) {}
  double Within(double limit) { return limit * (static_cast<double>(m_random()) / 2147483648.0 - 1); }
  std::uint32_t Below(std::size_t count) { return static_cast<std::uint32_t>(m_random() % count); }
  Box MakeBox(double spread, double largest) {
    const Vector3d middle(Within(spread), Within(spread), Within(spread / 4));
    const Vector3d half = Vector3d(Within(largest), Within(largest), Within(largest)).cwiseAbs();
    return {middle - half, middle + half};
  }

 private:
  std::mt19937 m_random;
};

std::vector<std::uint32_t> FindIn(const RestingBoxes& boxes, const Box& box) {
  std::vector<std::uint32_t> found;
  boxes.VisitOverlaps(box, [&](std::uint32_t body) { found.push_back(body); });
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<std::uint32_t> FindAmong(const std::map<std::uint32_t, Box>& all, const Box& box) {
  std::vector<std::uint32_t> found;
  for (const auto& [body, other] : all) {
    if (Overlap(other, box)) found.push_back(body);
  }
  return found;
}

class RestingBoxesOfSeed : public testing::TestWithParam<unsigned> {};

// Boxes are added and removed at random: small ones, large ones and some very far away. Queries have any size.
TEST_P(RestingBoxesOfSeed, FindWhatLookingAtAllFinds) {
  Draw draw(GetParam());
  RestingBoxes boxes;
  std::map<std::uint32_t, Box> all;
  std::size_t overlaps = 0;
  for (int round = 0; round < 4000; ++round) {
    const std::uint32_t body = draw.Below(400);
    if (all.contains(body)) {
      boxes.Remove(body);
      all.erase(body);
    } else {
      Box box = draw.MakeBox(12, draw.Below(40) == 0 ? 20 : 0.6);
      if (draw.Below(50) == 0) box = {box.low * 1e17, box.high * 1e17};
      boxes.Add(body, box);
      all[body] = box;
    }
    ASSERT_EQ(boxes.Count(), all.size());
    const Box wanted = draw.MakeBox(12, draw.Below(20) == 0 ? 30 : 1);
    const auto found = FindIn(boxes, wanted);
    ASSERT_EQ(found, FindAmong(all, wanted)) << "round " << round;
    overlaps += found.size();
  }
  EXPECT_GT(overlaps, 4000U);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RestingBoxesOfSeed, testing::Values(1U, 2U, 3U));

TEST(RestingBoxes, ABoxThatIsNoNumberFindsNobodyAndEndsSoon) {
  RestingBoxes boxes;
  for (std::uint32_t i = 0; i < 100; ++i) boxes.Add(i, {Vector3d(i, 0, 0), Vector3d(i + 0.5, 1, 1)});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(FindIn(boxes, {Vector3d::Constant(nan), Vector3d::Constant(nan)}).empty());
  EXPECT_EQ(FindIn(boxes, {Vector3d::Constant(-1e300), Vector3d::Constant(1e300)}).size(), 100U);
}

TEST(RestingBoxes, NumbersFollowWhenABodyIsGone) {
  RestingBoxes boxes;
  for (std::uint32_t i = 0; i < 10; ++i) boxes.Add(i, {Vector3d(2 * i, 0, 0), Vector3d(2 * i + 1, 1, 1)});
  boxes.Remove(4);
  boxes.Renumber(4);
  EXPECT_EQ(FindIn(boxes, {Vector3d(6, 0, 0), Vector3d(10.5, 1, 1)}), (std::vector<std::uint32_t>{3, 4}));
  boxes.Remove(4);  // which was 5
  EXPECT_EQ(FindIn(boxes, {Vector3d(6, 0, 0), Vector3d(10.5, 1, 1)}), (std::vector<std::uint32_t>{3}));
}

std::vector<std::uint32_t> AwakeOf(Roster& roster) {
  const auto awake = roster.FindAwake();
  return {awake.begin(), awake.end()};
}

TEST(Roster, KnowsWhoIsAwakeWhoeverComesAndGoes) {
  Draw draw(7);
  Roster roster;
  std::vector<bool> isAwake;
  std::vector<Box> boxes;
  for (int round = 0; round < 3000; ++round) {
    const std::size_t count = isAwake.size();
    const std::uint32_t body = draw.Below(std::max<std::size_t>(1, count));
    switch (draw.Below(4)) {
      case 0:
        if (count > 60) break;
        roster.Add();
        isAwake.push_back(true);
        boxes.push_back(draw.MakeBox(10, 1));
        break;
      case 1:
        if (count < 20) break;
        roster.Remove(body, !isAwake[body]);
        isAwake.erase(isAwake.begin() + body);
        boxes.erase(boxes.begin() + body);
        break;
      case 2:
        if (count == 0 || isAwake[body]) break;
        roster.Wake(body);
        isAwake[body] = true;
        break;
      default: {
        std::vector<std::uint32_t> falling;
        for (std::uint32_t i = body; i < count && i < body + 3U; ++i) {
          if (!isAwake[i]) continue;
          falling.push_back(i);
          isAwake[i] = false;
        }
        roster.LetSleep(falling, boxes);
      }
    }
    if (round % 3 != 0) continue;  // several changes at a time as well
    std::vector<std::uint32_t> expected;
    for (std::uint32_t i = 0; i < isAwake.size(); ++i) {
      if (isAwake[i]) expected.push_back(i);
    }
    ASSERT_EQ(AwakeOf(roster), expected) << "round " << round;
    ASSERT_EQ(roster.Sleepers().Count(), isAwake.size() - expected.size());
  }
}

}  // namespace
}  // namespace wobble::physics
