#include <gtest/gtest.h>

#include "server/physics/methods/runge_kutta.h"
#include "server/physics/methods/stability.h"
#include "server/physics/shapes/pair.h"
#include "server/physics/world.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

TEST(Stability, LadderGivesTheNextRung) {
  EXPECT_EQ(FindRung(0), 1);
  EXPECT_EQ(FindRung(1), 1);
  EXPECT_EQ(FindRung(1.01), 2);
  EXPECT_EQ(FindRung(5), 6);
  EXPECT_EQ(FindRung(64), 64);
  EXPECT_EQ(FindRung(1000), 64);
}

// Random trials found a pair whose spring was slow enough, but which needed more than kMaxSubsteps on the ground.
TEST(Stability, ABodyTooStiffForTheGroundIsRefused) {
  PairDefinition pair;
  pair.length = 0.5;
  pair.material.mass = 1;
  pair.material.stiffness = 4e5;
  ASSERT_TRUE(ValidatePair(pair).empty());
  const double needed = FindSubstepsOnGround(MakePair(pair), 1.0 / 60);
  EXPECT_LE(needed, kMaxSubsteps);
  pair.material.contactStiffness = 100 * pair.material.stiffness;
  EXPECT_GT(FindSubstepsOnGround(MakePair(pair), 1.0 / 60), kMaxSubsteps);
  EXPECT_FALSE(ValidatePair(pair).empty());

  // At least what a tick asks for when the body lies deep in the ground.
  pair.material.contactStiffness = 0;
  World world{WorldSettings{}};
  world.AddBlueprint(MakePair(pair));
  world.AddObstacle(Obstacle{});
  world.AddBody(0, Vector3d(0, 0, -0.1));
  const StepReport report = world.Step();
  EXPECT_GE(static_cast<double>(report.substeps), needed);
}

// Growth of a kicked free body over ten seconds at a given hω of its stiffest mode.
bool IsStable(const Blueprint& ball, double product) {
  std::vector<Vector3d> x = Deform(ball.rest, 1e-6);
  std::vector<Vector3d> v(x.size(), Vector3d::Zero());
  StageBuffers<double, 4> buffers;
  const double omega = ball.angularFrequency / 1.05;  // at rest, without the margin for squeezing
  const auto accelerate = [&](std::span<const Vector3d> at, std::span<const Vector3d> speed, std::span<Vector3d> a) {
    ComputeAccelerations<double>(ball.full, Load<double>{}, {}, {}, at, speed, a);
  };
  for (int i = 0; i < 3000; ++i) {
    StepRungeKutta<double>(kClassicRungeKutta, product / omega, accelerate, std::span(x), std::span(v), buffers);
    if (!(v[0].norm() < 1)) return false;
  }
  return true;
}

TEST(Stability, BodyIsStableUpToTheoryAndNotBeyond) {
  const Blueprint ball = MakeBall(MakeMeasuredBall(0));
  EXPECT_TRUE(IsStable(ball, 2.75));
  EXPECT_FALSE(IsStable(ball, 2.9)) << "2.83 is RK4's limit without damping";
}

TEST(Stability, ModeRateIsTheFrequencyOrTheFastDecay) {
  EXPECT_DOUBLE_EQ(FindModeRate(100, 0), 10);
  EXPECT_DOUBLE_EQ(FindModeRate(100, 20), 10);  // critical
  EXPECT_NEAR(FindModeRate(100, 50), 25 + std::sqrt(525.0), 1e-12);
}

TEST(Stability, PuffingAndStiffeningAskForSmallerSteps) {
  const Blueprint ball = MakeBall(MakeMeasuredBall(0.05));
  const State<double> state = MakeState<double>(ball, Vector3d::Zero(), Vector3d::Zero());
  bool light = false;
  Load<double> load;
  const double calm = FindLargestRate(FindModes<double>(ball, load, state, {}, {}), light);
  load.stiffnessFactor = 4;
  EXPECT_GE(FindLargestRate(FindModes<double>(ball, load, state, {}, {}), light), 1.9 * calm);
}

// Violent play in the server's own stepping: no body may blow up or turn inside out. Impacts carry up to the energy
// that the gas can take (nRT): above it a skin folds through itself, which is physics and not an instability. Seeded.
TEST(Stability, ViolentTrialsStayFinite) {
  std::uint64_t state = 20260101;
  const auto draw = [&](double low, double high) {
    state = state * 6364136223846793005U + 1442695040888963407U;
    return low + (high - low) * static_cast<double>(state >> 40) / 16777216.0;
  };
  unsigned trials = 0;
  while (trials < 60) {
    const std::uint64_t seed = state;
    BallDefinition ball;
    ball.subdivisions = static_cast<int>(draw(0, 2.4));
    ball.radius = draw(0.2, 1.5);
    ball.material.mass = std::exp(draw(0, 4));
    ball.material.stiffness = std::exp(draw(3, 9));
    ball.material.gas = std::exp(draw(2, 8));
    ball.material.dampingRatio = draw(0, 0.5);
    ball.material.friction = draw(0, 1.5);
    ball.material.restitution = draw(0, 1);
    if (!ValidateBall(ball).empty()) continue;
    if (ball.material.gas < 2 * 9.81 * ball.material.mass * ball.radius) continue;  // crushed by its own weight
    ++trials;
    World world{WorldSettings{}};
    world.AddBlueprint(MakeBall(ball));
    world.AddObstacle(Obstacle{});
    const double fastest = std::min(20.0, std::sqrt(2 * ball.material.gas / ball.material.mass));
    const Vector3d kick(draw(-10, 10), draw(-10, 10), draw(-0.7, 0.2) * fastest);
    const double highest = std::min(5.0, 0.3 * ball.material.gas / (9.81 * ball.material.mass));
    const BodyId id = world.AddBody(0, Vector3d(0, 0, ball.radius + draw(0, highest)), kick);
    for (int tick = 0; tick < 100; ++tick) {
      Control control;
      control.jump = tick % 20 == 0;
      control.puff = tick % 60 < 20;
      control.stiffen = tick % 50 < 25;
      control.moveX = tick % 40 < 20 ? 1 : -1;
      world.SetControl(id, control, ControlLimits{});
      const StepReport report = world.Step();
      ASSERT_EQ(report.nonFinite, 0U) << "trial seed " << seed << " tick " << tick;
      ASSERT_EQ(report.inverted, 0U) << "trial seed " << seed << " tick " << tick << ": radius " << ball.radius
                                     << ", mass " << ball.material.mass << ", stiffness " << ball.material.stiffness
                                     << ", gas " << ball.material.gas << ", subdivisions " << ball.subdivisions;
    }
    const Vector3d centre = world.FindCentre(world.ReadBody(id));
    ASSERT_LT(centre.norm(), 200) << "trial seed " << seed;
  }
}

}  // namespace
}  // namespace wobble::physics
