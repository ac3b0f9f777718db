// Each integration method by itself: order, largest stable step against theory, energy and momentum.
#include "server/physics/methods/integrator_step.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <limits>

#include "server/physics/methods/step_limits.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/world.h"
#include "tests/physics/bodies.h"
#include "tests/physics/lone_system.h"

namespace wobble::physics {
namespace {

constexpr Integrator kExplicit[] = {Integrator::kRungeKutta4, Integrator::kExplicitEuler,
                                    Integrator::kSemiImplicitEuler, Integrator::kVelocityVerlet, Integrator::kLeapFrog};
constexpr Integrator kOfSprings[] = {Integrator::kRungeKutta4,       Integrator::kExplicitEuler,
                                     Integrator::kSemiImplicitEuler, Integrator::kVelocityVerlet,
                                     Integrator::kLeapFrog,          Integrator::kImplicitEuler};

struct Motion {
  double stretch = 0;  // m
  double rate = 0;     // m/s
};

Motion MeasurePair(Integrator integrator, double omega, double damping, int steps, double h) {
  LoneSystem<double> pair(MakeOscillator(omega, damping), integrator);
  pair.Start({Vector3d(-0.55, 0, 0), Vector3d(0.55, 0, 0)}, {Vector3d::Zero(), Vector3d::Zero()});
  pair.Run(steps, h);
  return {(pair.x[1] - pair.x[0]).x() - 1, (pair.v[1] - pair.v[0]).x()};
}

double MeasurePairError(Integrator integrator, double omega, double damping, int steps) {
  const Motion motion = MeasurePair(integrator, omega, damping, steps, 1.0 / steps);
  const double half = damping / 2;
  const double ringing = std::sqrt(omega * omega - half * half);
  const double x = 0.1 * std::exp(-half) * (std::cos(ringing) + half / ringing * std::sin(ringing));
  const double v = -0.1 * std::exp(-half) * omega * omega / ringing * std::sin(ringing);
  return std::hypot(motion.stretch - x, (motion.rate - v) / omega);
}

double FindOrder(Integrator integrator, bool damped) {
  switch (integrator) {
    case Integrator::kRungeKutta4:
      return 4;
    case Integrator::kVelocityVerlet:
    case Integrator::kLeapFrog:
      return damped ? 1 : 2;
    default:
      return 1;
  }
}

class IntegratorTest : public testing::TestWithParam<Integrator> {};

TEST_P(IntegratorTest, HasItsOrderOnAnOscillator) {
  for (const double damping : {0.0, 4.0}) {
    const int steps = GetParam() == Integrator::kRungeKutta4 ? 100 : 4000;
    const double coarse = MeasurePairError(GetParam(), 10, damping, steps);
    const double fine = MeasurePairError(GetParam(), 10, damping, 8 * steps);
    EXPECT_NEAR(std::log(coarse / fine) / std::log(8.0), FindOrder(GetParam(), damping > 0), 0.1)
        << "damping " << damping << ": errors " << coarse << ", " << fine;
  }
}

std::vector<Vector3d> MeasureBall(const Blueprint& ball, Integrator integrator, int steps) {
  LoneSystem<double> system(ball, integrator);
  std::vector<Vector3d> spin;
  for (const Vector3d& at : ball.rest) spin.push_back(Vector3d(0.5, 1, -0.7).cross(at));
  system.Start(Deform(ball.rest, 0.05), spin);
  system.Run(steps, 0.25 / steps);
  return system.x;
}

double FindDistance(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]).squaredNorm();
  return std::sqrt(sum / static_cast<double>(a.size()));
}

TEST_P(IntegratorTest, HasItsOrderOnABall) {
  for (const double damping : {0.0, 0.2}) {
    BallDefinition definition = MakeMeasuredBall(damping);
    definition.subdivisions = 1;
    const Blueprint ball = MakeBall(definition);
    const std::vector<Vector3d> exact = MeasureBall(ball, Integrator::kRungeKutta4, 4000);
    const int steps = GetParam() == Integrator::kRungeKutta4 ? 50 : 1000;
    const double coarse = FindDistance(MeasureBall(ball, GetParam(), steps), exact);
    const double fine = FindDistance(MeasureBall(ball, GetParam(), 4 * steps), exact);
    EXPECT_NEAR(std::log(coarse / fine) / std::log(4.0), FindOrder(GetParam(), damping > 0), 0.15)
        << "damping ratio " << damping << ": errors " << coarse << ", " << fine;
  }
}

TEST_P(IntegratorTest, FallsFreely) {
  LoneSystem<double> system(MakeOscillator(10, 0), GetParam());
  system.load.acceleration = Vector3d(0, 0, -10);
  system.Start({Vector3d(0, 0, 0), Vector3d(1, 0, 0)}, {Vector3d(1, 0, 2), Vector3d(1, 0, 2)});
  system.Run(1000, 1e-3);
  // Methods of order 1 have an error of g h/2 t.
  EXPECT_NEAR(system.x[0].z(), 2 - 5, FindOrder(GetParam(), false) > 1 ? 1e-11 : 0.0051);
  EXPECT_NEAR(system.v[0].z(), 2 - 10, 1e-11);
  EXPECT_NEAR(system.x[1].x(), 2, 1e-11);
}

TEST_P(IntegratorTest, KeepsMomentum) {
  for (const Blueprint& blueprint : {MakeBall(MakeMeasuredBall(0.1)), MakeLattice(MakeJellyCube(0.1))}) {
    LoneSystem<double> system(blueprint, GetParam());
    system.Start(Deform(blueprint.rest, 0.02), std::vector<Vector3d>(blueprint.rest.size(), Vector3d(3, -2, 1)));
    const Vector3d before = system.FindMomentum();
    system.Run(2000, 1.0 / 2400);
    EXPECT_LT((system.FindMomentum() - before).norm(), 1e-11 * before.norm());
  }
}

// In float a body takes the same steps to within rounding.
TEST_P(IntegratorTest, IsTheSameInFloat) {
  const Blueprint ball = MakeBall(MakeMeasuredBall(0.1));
  LoneSystem<float> single(ball, GetParam());
  LoneSystem<double> exact(ball, GetParam());
  const std::vector<Vector3d> zero(ball.rest.size(), Vector3d::Zero());
  single.Start(Deform(ball.rest, 0.01), zero);
  exact.Start(Deform(ball.rest, 0.01), zero);
  single.Run(100, 1.0 / 480);
  exact.Run(100, 1.0 / 480);
  for (std::size_t i = 0; i < zero.size(); ++i) ASSERT_LT((single.x[i].cast<double>() - exact.x[i]).norm(), 1e-5);
}

std::string NameMethod(const testing::TestParamInfo<Integrator>& info) {
  constexpr const char* kNames[] = {"RungeKutta4", "ExplicitEuler",  "SemiImplicitEuler", "VelocityVerlet",
                                    "LeapFrog",    "PositionVerlet", "ImplicitEuler"};
  return kNames[static_cast<std::size_t>(info.param)];
}
INSTANTIATE_TEST_SUITE_P(All, IntegratorTest, testing::ValuesIn(kOfSprings), NameMethod);

// The magnitude of the larger eigenvalue of one step of the pair's swing, which is linear in stretch and rate.
double FindGrowth(Integrator integrator, double omega, double damping, double h) {
  LoneSystem<double> pair(MakeOscillator(omega, damping), integrator);
  const auto step = [&](double stretch, double rate) {
    pair.Start({Vector3d(0, 0, 0), Vector3d(1 + stretch, 0, 0)}, {Vector3d(0, 0, 0), Vector3d(rate, 0, 0)});
    pair.Run(1, h);
    return Eigen::Vector2d((pair.x[1] - pair.x[0]).x() - 1, (pair.v[1] - pair.v[0]).x() / omega);
  };
  Eigen::Matrix2d matrix;
  matrix << step(0.1, 0) / 0.1, step(0, 0.1 * omega) / 0.1;
  return matrix.eigenvalues().cwiseAbs().maxCoeff();
}

bool IsStable(Integrator integrator, double omega, double damping, double h) {
  return FindGrowth(integrator, omega, damping, h) < 1 + 1e-7;
}

class StepLimitTest : public testing::TestWithParam<Integrator> {};

TEST_P(StepLimitTest, IsWhatTheorySays) {
  constexpr double kOmega = 20;
  for (const double ratio : {0.0, 0.02, 0.1, 0.3, 0.5, 1.0, 1.5, 3.0}) {
    const double damping = 2 * ratio * kOmega;
    const double theory = FindLargestStep(GetParam(), kOmega * kOmega, damping);
    if (GetParam() == Integrator::kExplicitEuler && ratio == 0) {
      EXPECT_EQ(theory, 0);
      EXPECT_FALSE(IsStable(GetParam(), kOmega, 0, 0.1 / kOmega));
      continue;
    }
    // Searches from below: beyond the first unstable step there may be stable ones.
    double stable = 0.02 / kOmega;
    while (IsStable(GetParam(), kOmega, damping, 1.001 * stable)) stable *= 1.001;
    EXPECT_NEAR(stable / theory, 1, 0.002) << "damping ratio " << ratio;
    // The chosen step is stable, and not much smaller than it must be.
    const double chosen = 1 / FindStableRate(GetParam(), kOmega * kOmega, damping);
    if (GetParam() != Integrator::kExplicitEuler) {
      EXPECT_LE(chosen, 1.001 * theory) << "damping ratio " << ratio;
      EXPECT_GT(chosen, 0.7 * theory) << "damping ratio " << ratio;
    }
  }
}

// The damping of a body's slower modes is proportional to the square of their frequency.
TEST_P(StepLimitTest, IsChosenForTheSlowerModesAsWell) {
  if (GetParam() == Integrator::kExplicitEuler) return;
  for (double ratio = 0; ratio < 3; ratio += 0.01) {
    const double chosen = 1 / FindStableRate(GetParam(), 1, 2 * ratio);
    for (double share = 0.01; share <= 1; share += 0.01) {
      ASSERT_LE(chosen, 1.0001 * FindLargestStep(GetParam(), share, 2 * ratio * share))
          << "damping ratio " << ratio << ", square of frequency " << share;
    }
  }
}
INSTANTIATE_TEST_SUITE_P(All, StepLimitTest, testing::ValuesIn(kExplicit), NameMethod);

// All modes of a body are kicked: below the limit of the stiffest mode they stay small, above it they do not. For
// explicit Euler the least damped mode is the limit. In a lattice all modes are damped in proportion to their
// stiffness, which gives one limit; modes that the gas of a ball drives are not damped.
TEST_P(StepLimitTest, HoldsForABody) {
  const bool isEuler = GetParam() == Integrator::kExplicitEuler;
  const Blueprint ball = isEuler ? MakeLattice(MakeJellyCube(0.1)) : MakeBall(MakeMeasuredBall(0.1));
  const double omega = ball.angularFrequency / 1.05;  // at rest, without the margin for squeezing
  const double limit = FindLargestStep(GetParam(), omega * omega, ball.dampingRate / (1.05 * 1.05));
  const auto staysSmall = [&](double h) {
    LoneSystem<double> system(ball, GetParam());
    system.Start(Deform(ball.rest, 1e-7), std::vector<Vector3d>(ball.rest.size(), Vector3d::Zero()));
    for (int i = 0; i < 60; ++i) {
      system.Run(100, h);
      for (const Vector3d& v : system.v) {
        if (!(v.norm() < 1e-2)) return false;
      }
    }
    return true;
  };
  EXPECT_TRUE(staysSmall(0.97 * limit));
  EXPECT_FALSE(staysSmall(1.03 * limit));
}

TEST(Integrators, LimitsWithoutDampingAreTheKnownOnes) {
  EXPECT_NEAR(FindLargestStep(Integrator::kRungeKutta4, 100, 0), 0.1 * std::sqrt(8.0), 1e-9);
  EXPECT_DOUBLE_EQ(FindLargestStep(Integrator::kSemiImplicitEuler, 100, 0), 0.2);
  EXPECT_DOUBLE_EQ(FindLargestStep(Integrator::kVelocityVerlet, 100, 0), 0.2);
  EXPECT_DOUBLE_EQ(FindLargestStep(Integrator::kLeapFrog, 100, 0), 0.2);
  EXPECT_EQ(FindLargestStep(Integrator::kExplicitEuler, 100, 0), 0);
  EXPECT_DOUBLE_EQ(FindLargestStep(Integrator::kExplicitEuler, 100, 1), 0.01);
  EXPECT_TRUE(std::isinf(FindLargestStep(Integrator::kImplicitEuler, 100, 1)));
  EXPECT_DOUBLE_EQ(FindStableRate(Integrator::kExplicitEuler, 100, 0), 5) << "as semi-implicit Euler";
  EXPECT_EQ(FindStableRate(Integrator::kImplicitEuler, 100, 0), 0);
}

// The energy of an undamped pair after 1,000 swings, as a share of its energy at the beginning.
double MeasureEnergy(Integrator integrator, double product) {
  constexpr double kOmega = 10;
  const int steps = static_cast<int>(1000 * 2 * 3.14159265 / product);
  const Motion motion = MeasurePair(integrator, kOmega, 0, steps, product / kOmega);
  return (kOmega * kOmega * motion.stretch * motion.stretch + motion.rate * motion.rate) / (kOmega * kOmega * 0.01);
}

TEST(Integrators, DoToEnergyWhatTheyAreKnownFor) {
  EXPECT_GT(MeasureEnergy(Integrator::kExplicitEuler, 0.01), 1e6) << "explodes";
  EXPECT_LT(MeasureEnergy(Integrator::kImplicitEuler, 0.01), 1e-6) << "dies";
  for (const Integrator symplectic :
       {Integrator::kSemiImplicitEuler, Integrator::kVelocityVerlet, Integrator::kLeapFrog}) {
    EXPECT_NEAR(MeasureEnergy(symplectic, 0.1), 1, 0.11) << "sways about what it was";
  }
  EXPECT_NEAR(MeasureEnergy(Integrator::kRungeKutta4, 0.1), 1, 0.01);
}

// In a world, in the substeps that each method asks for, a ball and a cube fall, bounce and come to rest.
class WorldIntegratorTest : public testing::TestWithParam<Integrator> {};

TEST_P(WorldIntegratorTest, CarriesBodiesToRest) {
  for (const Precision precision : {Precision::kSingle, Precision::kDouble}) {
    WorldSettings settings;
    settings.precision = precision;
    World world(settings);
    BallDefinition definition;
    definition.subdivisions = 1;
    for (Blueprint blueprint : {MakeBall(definition), MakeLattice(MakeJellyCube(0.1))}) {
      SetIntegrator(blueprint, GetParam());
      world.AddBlueprint(std::move(blueprint));
    }
    world.AddObstacle(Obstacle{});
    world.AddBody(0, Vector3d(0, 0, 2));
    world.AddBody(0, Vector3d(0.1, 0, 4));  // onto the first
    world.AddBody(1, Vector3d(3, 0, 2));
    for (int tick = 0; tick < 1200; ++tick) {
      const StepReport report = world.Step();
      ASSERT_EQ(report.nonFinite + report.inverted, 0U) << "tick " << tick;
    }
    for (const Body& body : world.Bodies()) {
      const Vector3d before = world.FindCentre(body);
      EXPECT_GT(before.z(), 0.1);
      EXPECT_LT(before.z(), 2);
    }
    const Vector3d before = world.FindCentre(world.ReadBody(3));
    for (int tick = 0; tick < 60; ++tick) world.Step();
    EXPECT_LT((world.FindCentre(world.ReadBody(3)) - before).norm(), 2e-3) << "rests";
  }
}
INSTANTIATE_TEST_SUITE_P(All, WorldIntegratorTest,
                         testing::Values(Integrator::kRungeKutta4, Integrator::kSemiImplicitEuler,
                                         Integrator::kVelocityVerlet, Integrator::kLeapFrog,
                                         Integrator::kPositionVerlet, Integrator::kImplicitEuler),
                         NameMethod);

// Where no number of substeps is stable, explicit Euler takes those of semi-implicit Euler and gains energy.
TEST(Integrators, ExplicitEulerExplodesInTheWorld) {
  const auto play = [](Integrator integrator) {
    World world(WorldSettings{});
    Blueprint cube = MakeLattice(MakeJellyCube(0));
    SetIntegrator(cube, integrator);
    world.AddBlueprint(std::move(cube));
    const BodyId body = world.AddBody(0, Vector3d(0, 0, 500));
    auto& state = const_cast<State<float>&>(std::get<State<float>>(world.ReadBody(body).state));
    state.positions[0] += Vector3f(0.02F, 0.01F, 0.03F);
    const std::uint64_t substeps = world.Step().substeps;
    // Of the vertices, against the body's mean; infinite once a coordinate is.
    float fastest = 0;
    for (int tick = 0; tick < 300; ++tick) {
      if (world.Step().nonFinite > 0) fastest = std::numeric_limits<float>::infinity();
      Vector3f mean = Vector3f::Zero();
      for (const Vector3f& v : state.velocities) mean += v / static_cast<float>(state.velocities.size());
      for (const Vector3f& v : state.velocities) fastest = std::max(fastest, (v - mean).norm());
    }
    return std::pair(substeps, fastest);
  };
  const auto bounded = play(Integrator::kSemiImplicitEuler);
  const auto exploded = play(Integrator::kExplicitEuler);
  EXPECT_EQ(exploded.first, bounded.first);
  EXPECT_GT(exploded.second, 10 * bounded.second);
  EXPECT_LT(bounded.second, 10);
}

TEST(Integrators, IslandsThatDisagreeAreSteppedByRungeKutta) {
  const auto play = [](Integrator upper, Integrator lower) {
    WorldSettings settings;
    settings.gravity.setZero();
    World world(settings);
    for (const Integrator integrator : {upper, lower}) {
      Blueprint ball = MakeBall(BallDefinition{});
      SetIntegrator(ball, integrator);
      world.AddBlueprint(std::move(ball));
    }
    world.AddBody(0, Vector3d(0, 0, 0.97));
    world.AddBody(1, Vector3d(0, 0, 0));
    world.Step();
    return world.Hash();
  };
  const std::uint64_t classic = play(Integrator::kRungeKutta4, Integrator::kRungeKutta4);
  EXPECT_EQ(play(Integrator::kLeapFrog, Integrator::kImplicitEuler), classic);
  EXPECT_EQ(play(Integrator::kRungeKutta4, Integrator::kLeapFrog), classic);
  EXPECT_NE(play(Integrator::kLeapFrog, Integrator::kLeapFrog), classic);
}

}  // namespace
}  // namespace wobble::physics
