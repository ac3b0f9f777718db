// Position Verlet: lengths kept by relaxation, its order in free fall, a pendulum, torn springs, gas.
#include "server/physics/methods/position_verlet.h"

#include <gtest/gtest.h>

#include "server/physics/world.h"
#include "tests/physics/bodies.h"
#include "tests/physics/lone_system.h"

namespace wobble::physics {
namespace {

// A chain of 20 links of 5 cm that hangs from a fixed end.
Blueprint MakeChain() {
  Blueprint chain;
  for (std::uint32_t i = 0; i <= 20; ++i) {
    chain.rest.emplace_back(0.05 * i, 0, 0);
    chain.full.masses.push_back(0.01);
    if (i > 0) chain.full.springs.push_back({i - 1, i, 0.05, 100, 0});
  }
  FinishBlueprint(chain);
  chain.full.inverseMasses[0] = 0;
  return chain;
}

TEST(PositionVerlet, KeepsLengthsTheBetterTheMoreSweeps) {
  const Blueprint chain = MakeChain();
  const auto measure = [&](int sweeps) {
    LoneSystem<double> system(chain, Integrator::kPositionVerlet);
    std::vector<Vector3d> hanging;
    for (int i = 0; i <= 20; ++i) hanging.emplace_back(0, 0, -0.05 * i);
    system.Start(hanging, std::vector<Vector3d>(21, Vector3d::Zero()));
    system.load.acceleration = Vector3d(0, 0, -9.81);
    constexpr double kStep = 1.0 / 60;
    const auto accelerate = [&](auto, auto, std::span<Vector3d> a) {
      for (std::size_t i = 0; i < a.size(); ++i) a[i] = i == 0 ? Vector3d(0, 0, 0) : system.load.acceleration;
    };
    for (int i = 0; i < 600; ++i) {
      StepSemiImplicitEuler<double>(kStep, accelerate, std::span(system.x), std::span(system.v), system.scratch.stages);
      RelaxSprings<double>(kStep, system.ReadBody(0), sweeps, system.x, system.v);
    }
    EXPECT_LT(system.v[20].norm(), 1e-3) << "hangs still";
    return -system.x[20].z() - 1;
  };
  const double one = measure(1);
  const double four = measure(4);
  const double eight = measure(8);
  EXPECT_LT(four, one);
  EXPECT_LT(eight, four);
  RecordProperty("stretch", std::to_string(one) + " " + std::to_string(four) + " " + std::to_string(eight));
  std::printf("stretch of the chain with 1, 4, 8 sweeps: %g %g %g\n", one, four, eight);
}

// After relaxation the state's velocity is the motion of the step divided by its duration.
TEST(PositionVerlet, VelocityIsTheWayGone) {
  const Blueprint cube = MakeLattice(MakeJellyCube());
  LoneSystem<double> system(cube, Integrator::kPositionVerlet);
  system.load.acceleration = Vector3d(0, 0, -9.81);
  const std::vector<Vector3d> start = Deform(cube.rest, 0.03);
  system.Start(start, std::vector<Vector3d>(start.size(), Vector3d(1, 2, 3)));
  const Vector3d before = system.FindMomentum();
  system.Run(1, 0.01);
  for (std::size_t i = 0; i < start.size(); ++i) {
    EXPECT_LT((system.v[i] - (system.x[i] - start[i]) / 0.01).norm(), 1e-12);
  }
  const Vector3d fallen = before + Vector3d(0, 0, -9.81 * 0.01) * cube.totalMass;
  EXPECT_LT((system.FindMomentum() - fallen).norm(), 1e-12 * before.norm()) << "springs keep it";
}

TEST(PositionVerlet, IsOfOrderOneInFreeFall) {
  const auto measure = [](int steps) {
    LoneSystem<double> system(MakeOscillator(10, 0), Integrator::kPositionVerlet);
    system.load.acceleration = Vector3d(0, 0, -10);
    system.Start({Vector3d(0, 0, 0), Vector3d(1, 0, 0)}, {Vector3d::Zero(), Vector3d::Zero()});
    system.Run(steps, 1.0 / steps);
    return system.x[0].z() + 5;
  };
  EXPECT_NEAR(measure(100), -0.05, 1e-12);  // g h t/2
  EXPECT_NEAR(measure(1000), -0.005, 1e-12);
}

// A rigid pendulum of 1 m let go at 0.1 rad against θ'' = −g sin θ, after half a second.
TEST(PositionVerlet, SwingsAsAPendulum) {
  std::vector<Vector3d> angle{Vector3d(0.1, 0, 0)};
  std::vector<Vector3d> rate{Vector3d::Zero()};
  StageBuffers<double, 4> buffers;
  const auto swing = [](auto x, auto, std::span<Vector3d> a) { a[0] = Vector3d(-9.81 * std::sin(x[0].x()), 0, 0); };
  for (int i = 0; i < 1000; ++i) {
    StepRungeKutta<double>(kClassicRungeKutta, 0.0005, swing, std::span(angle), std::span(rate), buffers);
  }
  const auto measure = [&](int steps) {
    const double h = 0.5 / steps;
    LoneSystem<double> system(MakeOscillator(10, 0), Integrator::kPositionVerlet);
    system.blueprint.full.inverseMasses[0] = 0;
    system.Start({Vector3d::Zero(), Vector3d(std::sin(0.1), 0, -std::cos(0.1))}, {Vector3d::Zero(), Vector3d::Zero()});
    for (int i = 0; i < steps; ++i) {
      system.v[1].z() -= 9.81 * h;  // gravity on the free mass alone
      system.Run(1, h);
    }
    return std::fabs(system.x[1].x() - std::sin(angle[0].x()));
  };
  const double coarse = measure(100);
  const double fine = measure(800);
  EXPECT_LT(coarse, 2e-5);
  EXPECT_LT(fine, coarse / 8);
}

TEST(PositionVerlet, TornSpringsHoldNothing) {
  const Blueprint chain = MakeChain();
  LoneSystem<double> system(chain, Integrator::kPositionVerlet);
  system.torn.assign(20, 0);
  system.torn[10] = 1;
  std::vector<Vector3d> apart;
  for (int i = 0; i <= 20; ++i) apart.emplace_back(0.06 * i, 0, 0);
  system.Start(apart, std::vector<Vector3d>(21, Vector3d::Zero()));
  for (int i = 0; i < 200; ++i) RelaxSprings<double>(0.01, system.ReadBody(0), 1, system.x, system.v);
  EXPECT_NEAR((system.x[9] - system.x[10]).norm(), 0.05, 1e-6);
  EXPECT_GT((system.x[10] - system.x[11]).norm(), 0.1);
}

// Rest lengths are little more than half of the lengths at rest: kept at them the skin would crush its gas.
TEST(PositionVerlet, HoldsGasAtTheShapeOfRest) {
  LoneSystem<double> system(MakeBall(BallDefinition{}), Integrator::kPositionVerlet);
  const std::vector<Vector3d> rest = system.blueprint.rest;
  const Spring<double>& spring = system.blueprint.full.springs[0];
  EXPECT_LT(spring.restLength, 0.6 * (rest[spring.a] - rest[spring.b]).norm());
  system.Start(rest, std::vector<Vector3d>(rest.size(), Vector3d::Zero()));
  system.Run(600, 1.0 / 600);
  EXPECT_NEAR(ComputeVolume<double>(system.blueprint.full.faces, system.x) / system.blueprint.restVolume, 1, 0.05);
}

}  // namespace
}  // namespace wobble::physics
