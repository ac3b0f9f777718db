// Each integration method by itself: order, largest stable step against theory, energy and momentum.
#include "server/physics/methods/integrator_step.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "server/physics/methods/step_limits.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/world.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

constexpr Integrator kExplicit[] = {Integrator::kRungeKutta4, Integrator::kExplicitEuler,
                                    Integrator::kSemiImplicitEuler, Integrator::kVelocityVerlet, Integrator::kLeapFrog};
constexpr Integrator kOfSprings[] = {Integrator::kRungeKutta4,       Integrator::kExplicitEuler,
                                     Integrator::kSemiImplicitEuler, Integrator::kVelocityVerlet,
                                     Integrator::kLeapFrog,          Integrator::kImplicitEuler};

// One body alone, as a system.
template <class Real>
struct LoneSystem {
  LoneSystem(const Blueprint& made, Integrator chosen) : blueprint(made) { SetIntegrator(blueprint, chosen); }

  void Accelerate(std::span<const Vector3<Real>> atX, std::span<const Vector3<Real>> atV, std::span<Vector3<Real>> a,
                  bool springs) const {
    Load<Real> own = load;
    if (!springs) own.stiffnessFactor = 0;
    ComputeAccelerations<Real>(blueprint.Read<Real>(), own, surfaces, contacts, atX, atV, a);
  }
  [[nodiscard]] std::size_t CountBodies() const { return 1; }
  [[nodiscard]] SteppedBody<Real> ReadBody(std::size_t) const {
    return {&blueprint, &load, surfaces, contacts, torn, 0};
  }

  void Start(const std::vector<Vector3d>& positions, const std::vector<Vector3d>& velocities) {
    x.clear();
    v.clear();
    for (const Vector3d& p : positions) x.push_back(p.cast<Real>());
    for (const Vector3d& p : velocities) v.push_back(p.cast<Real>());
  }
  void Run(int steps, double h) {
    for (int i = 0; i < steps; ++i) {
      StepOnce<Real>(blueprint.integrator, static_cast<Real>(h), *this, std::span(x), std::span(v), scratch);
    }
  }
  [[nodiscard]] Vector3d FindMomentum() const {
    Vector3d sum = Vector3d::Zero();
    for (std::size_t i = 0; i < v.size(); ++i) sum += blueprint.full.masses[i] * v[i].template cast<double>();
    return sum;
  }

  Blueprint blueprint;
  Load<Real> load;
  std::vector<Surface<Real>> surfaces;
  std::vector<Contact<Real>> contacts;
  std::vector<std::uint8_t> torn;
  std::vector<Vector3<Real>> x;
  std::vector<Vector3<Real>> v;
  IntegratorScratch<Real> scratch;
};

// Two masses of 2 kg on a spring of 1 m along x. Their distance swings as x'' = −w² x − g x'.
Blueprint MakePair(double omega, double damping) {
  Blueprint pair;
  pair.rest = {Vector3d(0, 0, 0), Vector3d(1, 0, 0)};
  pair.full.masses = {2, 2};
  pair.full.springs = {{0, 1, 1.0, omega * omega, damping}};
  FinishBlueprint(pair);
  return pair;
}

struct Motion {
  double stretch = 0;  // m
  double rate = 0;     // m/s
};

Motion MeasurePair(Integrator integrator, double omega, double damping, int steps, double h) {
  LoneSystem<double> pair(MakePair(omega, damping), integrator);
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
  LoneSystem<double> system(MakePair(10, 0), GetParam());
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
  LoneSystem<double> pair(MakePair(omega, damping), integrator);
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

TEST(ImplicitEuler, IsStableAtAHundredTimesTheExplicitLimit) {
  BallDefinition small = MakeMeasuredBall(0);
  small.subdivisions = 1;
  for (const Blueprint& blueprint : {MakeBall(small), MakeBall(MakeMeasuredBall(0.1)), MakeLattice(MakeJellyCube(0))}) {
    const double omega = blueprint.angularFrequency / 1.05;
    const double h = 100 * FindLargestStep(Integrator::kSemiImplicitEuler, omega * omega, 0);
    LoneSystem<double> implicit(blueprint, Integrator::kImplicitEuler);
    const std::vector<Vector3d> zero(blueprint.rest.size(), Vector3d::Zero());
    implicit.Start(Deform(blueprint.rest, 0.02), zero);
    implicit.Run(1000, h);
    for (std::size_t i = 0; i < zero.size(); ++i) {
      ASSERT_LT((implicit.x[i] - implicit.x[0]).norm(), 4 * blueprint.reach);
      ASSERT_LT(implicit.v[i].norm(), 1e-3) << "comes to rest";
    }
    LoneSystem<double> direct(blueprint, Integrator::kSemiImplicitEuler);
    direct.Start(Deform(blueprint.rest, 0.02), zero);
    direct.Run(1000, h / 50);
    EXPECT_FALSE(direct.v[0].norm() < 1) << "which twice the explicit limit does not";
  }
}

// The same step by a dense matrix, made from the formulas alone: springs, gas, a contact and a fixed vertex.
TEST(ImplicitEuler, SolvesWhatADenseSolverSolves) {
  BallDefinition definition = MakeMeasuredBall(0.3);
  definition.subdivisions = 1;
  const Blueprint ball = MakeBall(definition);
  LoneSystem<double> system(ball, Integrator::kImplicitEuler);
  system.load.acceleration = Vector3d(0.3, 0, -9.81);
  system.load.gasFactor = 1.3;
  system.load.stiffnessFactor = 1.7;
  system.blueprint.full.inverseMasses[5] = 0;
  std::vector<Vector3d> start = Deform(ball.rest, 0.03);
  std::vector<Vector3d> velocity(start.size(), Vector3d(0.2, -0.1, 0.4));
  velocity = Deform(velocity, 0.5);
  velocity[5].setZero();
  std::size_t lowest = 0;
  for (std::size_t i = 0; i < start.size(); ++i) lowest = start[i].z() < start[lowest].z() ? i : lowest;
  velocity[lowest].z() = -0.3;
  Obstacle plane;
  plane.offset = start[lowest].z() + 0.004;
  system.surfaces = {MakeSurface<double>(plane, Vector3d::Zero())};
  system.contacts = {{0, static_cast<std::uint32_t>(lowest)}};
  system.Start(start, velocity);

  constexpr double kStep = 1.0 / 60;
  const Coefficients<double>& body = system.blueprint.full;
  const auto size = static_cast<Eigen::Index>(3 * start.size());
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(size, size);
  Eigen::MatrixXd damping = Eigen::MatrixXd::Zero(size, size);
  const auto add = [](Eigen::MatrixXd& to, std::size_t a, std::size_t b, const Eigen::Matrix3d& block) {
    to.block<3, 3>(static_cast<Eigen::Index>(3 * a), static_cast<Eigen::Index>(3 * b)) += block;
  };
  for (const Spring<double>& spring : body.springs) {
    const Vector3d l = start[spring.a] - start[spring.b];
    const Eigen::Matrix3d along = l * l.transpose() / l.squaredNorm();
    const double across = std::max(0.0, 1 - spring.restLength / l.norm());
    const Eigen::Matrix3d k = 1.7 * spring.stiffness * (along + across * (Eigen::Matrix3d::Identity() - along));
    const Eigen::Matrix3d c = 1.7 * spring.damping * along;
    for (const auto& [a, b, sign] : {std::tuple{spring.a, spring.a, 1},
                                     {spring.b, spring.b, 1},
                                     {spring.a, spring.b, -1},
                                     {spring.b, spring.a, -1}}) {
      add(stiffness, a, b, sign * k);
      add(damping, a, b, sign * c);
    }
  }
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(size);
  const double volume = ComputeVolume<double>(body.faces, start);
  for (std::size_t i = 0; i < start.size(); ++i) {  // by differences of the volume, which is linear in each coordinate
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<Vector3d> moved = start;
      moved[i][axis] += 0.01;
      gradient[static_cast<Eigen::Index>(3 * i) + axis] = (ComputeVolume<double>(body.faces, moved) - volume) / 0.01;
    }
  }
  stiffness += 1.3 * body.gas / (volume * volume) * gradient * gradient.transpose();
  const ContactStiffness<double> contact = FindContactStiffness<double>(
      body.contact, body.contactShares, system.surfaces, system.contacts[0], start, velocity);
  EXPECT_GT(contact.stiffness, 0);
  const Eigen::Matrix3d up = contact.normal * contact.normal.transpose();
  add(stiffness, lowest, lowest, contact.stiffness * up + contact.stickStiffness * (Eigen::Matrix3d::Identity() - up));
  add(damping, lowest, lowest, contact.damping * up + contact.stickDamping * (Eigen::Matrix3d::Identity() - up));

  std::vector<Vector3d> a(start.size());
  system.Accelerate(start, velocity, a, true);
  Eigen::MatrixXd matrix = kStep * kStep * stiffness + kStep * damping;
  Eigen::VectorXd v(size);
  Eigen::VectorXd force(size);
  for (std::size_t i = 0; i < start.size(); ++i) {
    add(matrix, i, i, body.masses[i] * Eigen::Matrix3d::Identity());
    v.segment<3>(static_cast<Eigen::Index>(3 * i)) = velocity[i];
    force.segment<3>(static_cast<Eigen::Index>(3 * i)) = body.masses[i] * a[i];
  }
  Eigen::VectorXd right = kStep * (force - kStep * stiffness * v);
  for (Eigen::Index row = 15; row < 18; ++row) {  // of vertex 5
    matrix.row(row).setZero();
    matrix.col(row).setZero();
    matrix(row, row) = 1;
    right[row] = 0;
  }
  const Eigen::VectorXd change = matrix.fullPivLu().solve(right);

  system.Run(1, kStep);
  for (std::size_t i = 0; i < start.size(); ++i) {
    const Vector3d expected = velocity[i] + change.segment<3>(static_cast<Eigen::Index>(3 * i));
    EXPECT_LT((system.v[i] - expected).norm(), 1e-10) << "vertex " << i;
    EXPECT_LT((system.x[i] - start[i] - kStep * expected).norm(), 1e-10) << "vertex " << i;
  }
  EXPECT_EQ(system.x[5], start[5]) << "fixed";
}

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
    LoneSystem<double> system(MakePair(10, 0), Integrator::kPositionVerlet);
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
    LoneSystem<double> system(MakePair(10, 0), Integrator::kPositionVerlet);
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
    unsigned broken = 0;
    for (int tick = 0; tick < 300; ++tick) broken += world.Step().nonFinite;
    return std::pair(substeps, broken > 0);
  };
  const auto bounded = play(Integrator::kSemiImplicitEuler);
  EXPECT_EQ(play(Integrator::kExplicitEuler), std::pair(bounded.first, true));
  EXPECT_FALSE(bounded.second);
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
