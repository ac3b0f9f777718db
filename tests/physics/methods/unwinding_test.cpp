// The couple that takes a second turn out of a ring: turning numbers, both momenta, and that the ring is whole again.
#include "server/physics/methods/unwinding.h"

#include <gtest/gtest.h>

#include <numbers>

#include "server/physics/shapes/ring.h"
#include "tests/bench/random.h"
#include "tests/support/broken_states.h"

namespace wobble::physics {
namespace {

using Shape = std::vector<Vector3d>;

Blueprint MakeRingOf(int points) {
  RingDefinition ring;
  ring.points = points;
  return MakeRing(ring);
}

// A ring that goes `turns` times round a circle of half its radius, a little uneven.
Shape Wind(const Blueprint& ring, int turns, bench::Random& random) {
  Shape x;
  const auto count = static_cast<double>(ring.rest.size());
  for (std::size_t i = 0; i < ring.rest.size(); ++i) {
    const double angle = 2 * std::numbers::pi * turns * static_cast<double>(i) / count;
    x.emplace_back(0.25 * std::cos(angle) + random.Draw(-0.01, 0.01), 0,
                   0.25 * std::sin(angle) + random.Draw(-0.01, 0.01));
  }
  return x;
}

int FindTurns(const Blueprint& ring, const Shape& x) { return FindTurningNumber<double>(ring.full.outline, x); }

TEST(Unwinding, CountsTheTurns) {
  const Blueprint ring = MakeRingOf(24);
  bench::Random random(3);
  for (const int turns : {-2, -1, 1, 2, 3}) EXPECT_EQ(FindTurns(ring, Wind(ring, turns, random)), turns);
  Shape eight = ring.rest;
  for (Vector3d& at : eight) at.x() *= at.z();
  EXPECT_EQ(FindTurns(ring, eight), 0);
  // However it is turned, edges along an axis included.
  const Blueprint square = MakeRingOf(4);
  for (int i = 0; i < 360; ++i) {
    const double angle = i * std::numbers::pi / 180;
    Shape turned = square.rest;
    for (Vector3d& at : turned) {
      at = Vector3d(std::cos(angle) * at.x() - std::sin(angle) * at.z(), 0,
                    std::sin(angle) * at.x() + std::cos(angle) * at.z());
    }
    EXPECT_EQ(FindTurns(square, turned), 1) << i;
  }
}

TEST(Unwinding, KeepsBothMomenta) {
  const Blueprint ring = MakeRingOf(24);
  bench::Random random(4);
  for (int trial = 0; trial < 100; ++trial) {
    const Shape x = Break(Broken::kRandom, ring, random);
    Vector3d sum = Vector3d::Zero();
    Vector3d torque = Vector3d::Zero();
    double largest = 0;
    for (const auto& [vertex, force] : FindUnwinding<double>(ring.full, x)) {
      sum += force;
      torque += x[vertex].cross(force);
      largest = std::max(largest, force.norm());
    }
    EXPECT_GT(largest, 0);
    EXPECT_LT(sum.norm(), 1e-12 * largest);
    EXPECT_LT(torque.norm(), 1e-12 * largest);
  }
}

TEST(Unwinding, ARingThatGoesRoundMoreThanOnceComesBack) {
  for (const int points : {8, 13, 24, 48}) {
    const Blueprint ring = MakeRingOf(points);
    for (const int turns : {2, 3}) {
      bench::Random random(static_cast<std::uint64_t>(10 * points + turns));
      const Recovery recovery = PlayRecovery(ring, Wind(ring, turns, random));
      EXPECT_TRUE(recovery.IsWhole()) << points << " points, " << turns << " turns: " << recovery.shape;
    }
  }
}

}  // namespace
}  // namespace wobble::physics
