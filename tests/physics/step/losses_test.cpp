// Losses take energy and nothing else, at the rates that they are named by.
#include "server/physics/step/losses.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "server/physics/shapes/pair.h"
#include "server/physics/shapes/ring.h"
#include "server/physics/world.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

constexpr double kLossTick = 1.0 / 60;

struct Totals {
  Vector3d momentum = Vector3d::Zero();
  Vector3d angularMomentum = Vector3d::Zero();
  double energy = 0;
};

Totals AddUp(const Blueprint& blueprint, const State<double>& state) {
  Totals totals;
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    const Vector3d momentum = blueprint.full.masses[i] * state.velocities[i];
    totals.momentum += momentum;
    totals.angularMomentum += state.positions[i].cross(momentum);
    totals.energy += momentum.dot(state.velocities[i]) / 2;
  }
  return totals;
}

State<double> MakeShaken(const Blueprint& blueprint, unsigned seed) {
  State<double> state = MakeState<double>(blueprint, Vector3d(0, 0, 0.45), Vector3d::Zero());
  std::mt19937 random(seed);
  const auto draw = [&] { return static_cast<double>(random() % 2001) / 1000 - 1; };
  for (std::size_t i = 0; i < state.positions.size(); ++i) {
    state.positions[i] += 0.05 * Vector3d(draw(), blueprint.full.planar ? 0 : draw(), draw());
    state.velocities[i] = 3 * Vector3d(draw(), blueprint.full.planar ? 0 : draw(), draw());
  }
  return state;
}

void Lose(const Blueprint& blueprint, double duration, std::span<const Surface<double>> surfaces,
          State<double>& state) {
  std::vector<double> scratch;
  ApplyLosses<double>(blueprint, surfaces, duration, scratch, state);
}

TEST(Losses, GasKeepsMomentumAndTakesEnergy) {
  RingDefinition ring;
  ring.material.dampingRatio = 0.1;
  for (const Blueprint& blueprint : {MakeBall(BallDefinition{}), MakeRing(ring)}) {
    ASSERT_GT(blueprint.gasViscosity, 0);
    for (const double duration : {1e-6, kLossTick, 10.0}) {
      State<double> state = MakeShaken(blueprint, 1);
      const Totals before = AddUp(blueprint, state);
      Lose(blueprint, duration, {}, state);
      const Totals after = AddUp(blueprint, state);
      EXPECT_LT((after.momentum - before.momentum).norm(), 1e-12 * before.energy);
      EXPECT_LT((after.angularMomentum - before.angularMomentum).norm(), 1e-12 * before.energy);
      EXPECT_LT(after.energy, before.energy) << duration;
    }
  }
}

// V' of a ball that breathes falls by e^{−2ζωT}, ω² = nRT/V² Σ|∂V/∂xᵢ|²/mᵢ; for a sphere that is 3P·4πr/m.
TEST(Losses, GasDampsBreathingAtItsRatio) {
  BallDefinition ball;
  ball.subdivisions = 3;
  for (const double ratio : {0.1, 0.5, 1.0}) {
    ball.material.gasDampingRatio = ratio;
    const Blueprint blueprint = MakeBall(ball);
    State<double> state = MakeState<double>(blueprint, Vector3d::Zero(), Vector3d::Zero());
    for (std::size_t i = 0; i < state.positions.size(); ++i) state.velocities[i] = 0.1 * state.positions[i];
    const double before = AddUp(blueprint, state).energy;
    Lose(blueprint, kLossTick, {}, state);
    const double radius = blueprint.size;
    const double pressure = ball.material.gas / blueprint.restVolume;
    const double frequency = std::sqrt(12 * std::numbers::pi * radius * pressure / ball.material.mass);
    const double left = std::sqrt(AddUp(blueprint, state).energy / before);
    EXPECT_NEAR(left, std::exp(-2 * ratio * frequency * kLossTick), 0.02) << ratio;
  }
}

TEST(Losses, BodiesWithoutDampingOrSupportLoseNothing) {
  BallDefinition ball;
  ball.material.dampingRatio = 0;
  for (const Blueprint& blueprint : {MakeBall(ball), MakeLattice(LatticeDefinition{}), MakePair(PairDefinition{})}) {
    State<double> state = MakeShaken(blueprint, 2);
    const State<double> before = state;
    Lose(blueprint, kLossTick, {}, state);
    EXPECT_EQ(state.velocities, before.velocities) << blueprint.name;
  }
}

// One tick on the ground, with contacts that press at any depth: rotation alone is lost.
TEST(Losses, RollingTakesRotationAlone) {
  BallDefinition ball;
  ball.material.gasDampingRatio = 0;
  const std::vector<Surface<double>> ground{MakeSurface<double>(Obstacle{}, Vector3d::Zero())};
  for (Blueprint blueprint : {MakeBall(ball), MakeLattice(LatticeDefinition{}), MakePair(PairDefinition{})}) {
    for (const double duration : {kLossTick, 100.0}) {
      State<double> state = MakeShaken(blueprint, 3);
      state.contacts = {{.surface = 0, .vertex = 0, .touching = true}, {.surface = 0, .vertex = 1, .touching = true}};
      state.positions[0].z() = state.positions[1].z() = -0.05;
      const Totals before = AddUp(blueprint, state);
      Vector3d centre = Vector3d::Zero();
      for (std::size_t i = 0; i < state.positions.size(); ++i) {
        centre += blueprint.full.masses[i] / blueprint.totalMass * state.positions[i];
      }
      Lose(blueprint, duration, ground, state);
      const Totals after = AddUp(blueprint, state);
      EXPECT_LT((after.momentum - before.momentum).norm(), 1e-9 * before.energy) << blueprint.name;
      EXPECT_LT(after.energy, before.energy) << blueprint.name;
      const double spinning = (after.angularMomentum - centre.cross(after.momentum)).norm();
      const double spun = (before.angularMomentum - centre.cross(before.momentum)).norm();
      EXPECT_LT(spinning, duration > 1 ? 0.01 * spun : spun) << blueprint.name;
      for (const Vector3d& v : state.velocities) EXPECT_TRUE(v.allFinite());
    }
  }
}

// The speed, m/s, that a ball loses in 1.2 s of rolling.
double FindRollingLoss(double coefficient) {
  World world(WorldSettings{});
  BallDefinition ball;
  ball.material.rollingResistance = coefficient;
  const Blueprint blueprint = MakeBall(ball);
  world.AddBlueprint(blueprint);
  world.AddObstacle(Obstacle{});
  const BodyId id = world.AddBody(0, Vector3d(0, 0, 0.95 * blueprint.size));
  for (int tick = 0; tick < 600; ++tick) world.Step();
  const Vector3d centre = world.FindCentre(world.ReadBody(id));
  const std::vector<Vector3d> x = ListPositions(world, id);
  std::vector<Vector3d> v;
  for (const Vector3d& each : x) v.push_back(Vector3d(2, 0, 0) + Vector3d(0, 2 / centre.z(), 0).cross(each - centre));
  world.SetMotion(id, x, v);
  std::vector<double> places;
  for (int tick = 0; tick <= 100; ++tick) {
    world.Step();
    places.push_back(world.FindCentre(world.ReadBody(id)).x());
  }
  const auto speed = [&](std::size_t from) { return (places[from + 20] - places[from]) / (20 * kLossTick); };
  return speed(8) - speed(80);
}

// A rolling shell of mass m and radius R has the inertia ⅔mR², so the moment C m g R slows it by 3/5 C g.
TEST(Losses, ARollingBallSlowsDownByItsCoefficient) {
  const double expected = 0.6 * 0.05 * 9.81 * 1.2;
  EXPECT_NEAR(FindRollingLoss(0.05) - FindRollingLoss(0), expected, 0.25 * expected);
}

TEST(Losses, ADroppedBallLiesStillSoon) {
  World world(WorldSettings{});
  BallDefinition ball;
  ball.subdivisions = 1;
  world.AddBlueprint(MakeBall(ball));
  world.AddObstacle(Obstacle{});
  const BodyId id = world.AddBody(0, Vector3d(0, 0, 1.5), Vector3d(1, 0, 0));
  int ticks = 0;
  while (!world.ReadBody(id).asleep && ++ticks < 3600) world.Step();
  EXPECT_LT(ticks, 20 * 60);
}

}  // namespace
}  // namespace wobble::physics
