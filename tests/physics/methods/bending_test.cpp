// Hinges of sheets: energy, forces, invariance, damping, and the flexural rigidity of what they make against the theory
// of thin plates.
#include "server/physics/methods/bending.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <numbers>

#include "server/physics/methods/runge_kutta.h"
#include "server/physics/shapes/cloth.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

constexpr double kRigidity = 0.3;  // D, J

ClothDefinition MakeCard(std::array<int, 2> points, Pinned pinned, double dampingRatio = 0) {
  ClothDefinition card;
  card.points = points;
  card.orientation = Orientation::kHorizontal;
  card.pinned = pinned;
  card.bend = 0;
  card.bendStiffness = kRigidity;
  card.material.dampingRatio = dampingRatio;
  card.material.drag = 0;
  return card;
}

std::vector<Vector3d> FindHingeForces(const Blueprint& card, const std::vector<Vector3d>& x,
                                      const std::vector<Vector3d>& v) {
  std::vector<Vector3d> forces(x.size(), Vector3d::Zero());
  AddHinges<double>(card.full.hinges, card.full.hingeFloorSquare, 1, x, v, forces);
  return forces;
}

// Flat, wrinkled, folded, and in disorder.
std::vector<std::vector<Vector3d>> MakeCardStates(const Blueprint& card) {
  std::vector<Vector3d> folded = card.rest;
  for (Vector3d& at : folded) at = Vector3d(std::fabs(at.x()), at.y(), 0.01 * at.y());
  return {card.rest, Deform(card.rest, 0.005), folded, Deform(card.rest, 0.3)};
}

void StepAlone(const Blueprint& body, double step, int steps, std::vector<Vector3d>& x, std::vector<Vector3d>& v) {
  StageBuffers<double, 4> buffers;
  const auto accelerate = [&](std::span<const Vector3d> at, std::span<const Vector3d> speed, std::span<Vector3d> a) {
    ComputeAccelerations<double>(body.full, Load<double>{}, {}, {}, at, speed, a);
  };
  for (int i = 0; i < steps; ++i) {
    StepRungeKutta<double>(kClassicRungeKutta, step, accelerate, std::span(x), std::span(v), buffers);
  }
}

TEST(Bending, ForcesAreTheGradientOfTheEnergy) {
  constexpr double kStep = 1e-5;
  const Blueprint card = MakeCloth(MakeCard({5, 4}, Pinned::kNone));
  for (std::vector<Vector3d> x : MakeCardStates(card)) {
    const std::vector<Vector3d> forces = FindHingeForces(card, x, std::vector<Vector3d>(x.size(), Vector3d::Zero()));
    for (std::size_t i = 0; i < x.size(); ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        const double at = x[i][axis];
        x[i][axis] = at + kStep;
        const double above = ComputeBendingEnergy(card.full, x);
        x[i][axis] = at - kStep;
        const double below = ComputeBendingEnergy(card.full, x);
        x[i][axis] = at;
        ASSERT_NEAR(forces[i][axis], -(above - below) / (2 * kStep), 1e-8 * card.full.hinges[0].stiffness);
      }
    }
  }
}

TEST(Bending, ForcesAddUpToNoForceAndNoTorqueAndTakeEnergy) {
  const Blueprint card = MakeCloth(MakeCard({5, 4}, Pinned::kNone, 0.3));
  for (const std::vector<Vector3d>& x : MakeCardStates(card)) {
    const std::vector<Vector3d> still(x.size(), Vector3d::Zero());
    const std::vector<Vector3d> v = Deform(std::vector<Vector3d>(x.size(), Vector3d(1, -2, 3)), 2);
    const std::vector<Vector3d> forces = FindHingeForces(card, x, v);
    const std::vector<Vector3d> elastic = FindHingeForces(card, x, still);
    Vector3d sum = Vector3d::Zero();
    Vector3d torque = Vector3d::Zero();
    double power = 0;
    for (std::size_t i = 0; i < x.size(); ++i) {
      sum += forces[i];
      torque += x[i].cross(forces[i]);
      power += v[i].dot(forces[i] - elastic[i]);
    }
    EXPECT_LT(sum.norm(), 1e-10);
    EXPECT_LT(torque.norm(), 1e-10);
    EXPECT_LE(power, 0);
  }
}

TEST(Bending, NeitherTurningNorStretchingInThePlaneBends) {
  const Blueprint card = MakeCloth(MakeCard({6, 5}, Pinned::kNone, 0.3));
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.1, Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  Eigen::Matrix3d stretch;
  stretch << 1.3, 0.2, 0, 0.1, 0.7, 0, 0, 0, 1;
  std::vector<Vector3d> x;
  std::vector<Vector3d> turning;
  for (const Vector3d& at : card.rest) x.push_back(turn * stretch * at + Vector3d(1, 2, 3));
  EXPECT_NEAR(ComputeBendingEnergy(card.full, x), 0, 1e-20);
  // A bent sheet that turns is not slowed.
  const std::vector<Vector3d> bent = MakeCardStates(card)[2];
  for (const Vector3d& at : bent) turning.push_back(Vector3d(3, 1, -2).cross(at));
  const std::vector<Vector3d> still(bent.size(), Vector3d::Zero());
  const std::vector<Vector3d> moved = FindHingeForces(card, bent, turning);
  const std::vector<Vector3d> elastic = FindHingeForces(card, bent, still);
  for (std::size_t i = 0; i < bent.size(); ++i) EXPECT_LT((moved[i] - elastic[i]).norm(), 1e-12);
}

// Two sides that keep their length: E = D (1 − cos θ) for each h of width.
TEST(Bending, AHingeIsAnAngleSpring) {
  const ClothDefinition definition = MakeCard({3, 2}, Pinned::kNone);
  const Blueprint strip = MakeCloth(definition);
  for (const double angle : {0.001, 0.3, 1.5, 3.1}) {
    std::vector<Vector3d> x = strip.rest;
    for (Vector3d& at : x) {
      if (at.x() > 1e-6) at = Vector3d(std::cos(angle) * at.x(), at.y(), std::sin(angle) * at.x());
    }
    const double energy = kRigidity * 2 * std::pow(std::sin(angle / 2), 2);  // of a strip that is one h wide
    EXPECT_NEAR(ComputeBendingEnergy(strip.full, x), energy, 1e-9 * energy) << angle;
  }
}

// A sheet on a cylinder stores ½ D κ² an area, whichever way it is bent. Along its border there are no hinges across.
TEST(Bending, ACylinderCostsTheSameInEveryDirection) {
  constexpr int kColumns = 31;
  constexpr int kRows = 26;
  constexpr double kRadius = 20;
  const ClothDefinition definition = MakeCard({kColumns, kRows}, Pinned::kNone);
  const Blueprint card = MakeCloth(definition);
  for (const double degrees : {0.0, 20.0, 45.0, 70.0, 90.0, 135.0}) {
    const double direction = degrees * std::numbers::pi / 180;
    const Vector3d along(std::cos(direction), std::sin(direction), 0);
    std::vector<Vector3d> x;
    for (const Vector3d& at : card.rest) {
      const double way = at.dot(along);
      x.push_back(at + (kRadius * std::sin(way / kRadius) - way) * along +
                  Vector3d(0, 0, kRadius * (1 - std::cos(way / kRadius))));
    }
    const double square = definition.spacing * definition.spacing;
    const double ofRows = std::pow(along.x(), 4) * (kColumns - 2) * (kRows - 1);
    const double ofColumns = std::pow(along.y(), 4) * (kColumns - 1) * (kRows - 2);
    const double ofTwist = 2 * std::pow(along.x() * along.y(), 2) * (kColumns - 1) * (kRows - 1);
    const double density = kRigidity / 2 / kRadius / kRadius;
    const double energy = ComputeBendingEnergy(card.full, x);
    EXPECT_NEAR(energy, density * square * (ofRows + ofColumns + ofTwist), 1e-4 * energy) << degrees;
    EXPECT_NEAR(energy, density * square * (kColumns - 1) * (kRows - 1), 0.05 * energy) << degrees;
  }
}

// The angular frequency of a small motion that begins at rest in its largest deflection, by when `read` passes zero.
template <class Read>
double MeasureFrequency(const Blueprint& card, std::vector<Vector3d> x, double expected, const Read& read) {
  const double step = 1 / card.angularFrequency;
  const int most = static_cast<int>(7 / expected / step);
  std::vector<Vector3d> v(x.size(), Vector3d::Zero());
  double before = read(x);
  int crossings = 0;
  double last = 0;
  for (int i = 0; i < most && crossings < 2; ++i) {
    StepAlone(card, step, 1, x, v);
    const double now = read(x);
    if (now * before < 0) {
      last = step * (i + before / (before - now));
      ++crossings;
    }
    before = now;
  }
  return crossings == 2 ? 1.5 * std::numbers::pi / last : 0;
}

double FindDensity(const ClothDefinition& card) {  // kg/m²
  return card.material.mass / ((card.points[0] - 1) * (card.points[1] - 1) * card.spacing * card.spacing);
}

// A square plate on simple supports swings at ω = 2π²/L² √(D/ρ) (Timoshenko & Woinowsky-Krieger 1959). Twist and bend
// both count: without the hinges of squares it would be √½ of that.
TEST(Bending, APlateOnSupportsSwingsAsInTheory) {
  for (const int points : {12, 17}) {
    ClothDefinition definition = MakeCard({points, points}, Pinned::kFrame);
    definition.bendStiffness = 3;
    const Blueprint card = MakeCloth(definition);
    const double length = (points - 1) * definition.spacing;
    const double pi = std::numbers::pi;
    const double theory = 2 * pi * pi / length / length * std::sqrt(definition.bendStiffness / FindDensity(definition));
    std::vector<Vector3d> x = card.rest;
    for (Vector3d& at : x) at.z() = 1e-4 * std::cos(pi * at.x() / length) * std::cos(pi * at.y() / length);
    const auto middle = static_cast<std::size_t>(points / 2 * points + points / 2);
    const double measured = MeasureFrequency(card, x, theory, [&](const auto& at) { return at[middle].z(); });
    EXPECT_NEAR(measured * measured, theory * theory, 0.02 * theory * theory) << points;  // D, within 2 %
  }
}

// A strip clamped at one end swings at ω = 1.8751²/L² √(D/ρ), along rows and along columns. It begins half a cell
// before the last row that is held: there its slope is zero. The shape it starts with is the first mode's.
TEST(Bending, AClampedStripSwingsAsInTheory) {
  for (const int columns : {2, 4}) {
    ClothDefinition definition = MakeCard({columns, 14}, Pinned::kClamp);
    definition.bendStiffness = 3;
    const Blueprint card = MakeCloth(definition);
    ASSERT_EQ(card.full.fixed.size(), 2U * columns);
    const double length = 12.5 * definition.spacing;
    constexpr double kRoot = 1.87510407;
    const double theory =
        kRoot * kRoot / length / length * std::sqrt(definition.bendStiffness / FindDensity(definition));
    const double ratio = (std::cos(kRoot) + std::cosh(kRoot)) / (std::sin(kRoot) + std::sinh(kRoot));
    const double clamp = card.rest[0].y() - definition.spacing / 2;
    std::vector<Vector3d> x = card.rest;
    for (std::size_t i = 2U * columns; i < x.size(); ++i) {
      const double along = kRoot * (clamp - x[i].y()) / length;
      x[i].z() = 1e-4 * (std::cosh(along) - std::cos(along) - ratio * (std::sinh(along) - std::sin(along)));
    }
    const double measured = MeasureFrequency(card, x, theory, [](const auto& at) { return at.back().z(); });
    EXPECT_NEAR(measured * measured, theory * theory, 0.02 * theory * theory) << columns;
  }
}

// The fastest wave of a grid: 64 D/h² on each vertex's mass. Its damping rate is c/k of that.
TEST(Bending, TheFrequencyIsTheLargestThatTheGridCarries) {
  ClothDefinition definition = MakeCard({30, 30}, Pinned::kNone, 0.25);
  definition.bendStiffness = 20;
  definition.material.stiffness = 1;
  const Blueprint card = MakeCloth(definition);
  const double square = definition.spacing * definition.spacing;
  const double mass = FindDensity(definition) * square;
  const double theory = std::sqrt(64 * definition.bendStiffness / square / mass);
  EXPECT_GT(card.angularFrequency, 0.99 * theory);
  EXPECT_LT(card.angularFrequency, 1.06 * theory);
  const double ratio = card.full.hinges[0].damping / card.full.hinges[0].stiffness;
  EXPECT_NEAR(card.dampingRate, ratio * card.angularFrequency * card.angularFrequency, 0.1 * card.dampingRate);
}

TEST(Bending, AFreeSheetKeepsItsMomentaAndLosesEnergyByDampingAlone) {
  for (const double dampingRatio : {0.0, 0.2}) {
    ClothDefinition definition = MakeCard({6, 5}, Pinned::kNone, dampingRatio);
    definition.bendStiffness = 2;
    Blueprint card = MakeCloth(definition);
    for (Spring<double>& spring : card.full.springs) spring.damping = 0;  // the hinges' alone
    std::vector<Vector3d> x = MakeCardStates(card)[1];
    std::vector<Vector3d> v;
    for (const Vector3d& at : card.rest) v.push_back(Vector3d(3, -2, 1) + Vector3d(0.5, 1, -0.7).cross(at));
    const auto measure = [&] {
      Vector3d momentum = Vector3d::Zero();
      Vector3d angular = Vector3d::Zero();
      for (std::size_t i = 0; i < x.size(); ++i) {
        momentum += card.full.masses[i] * v[i];
        angular += card.full.masses[i] * x[i].cross(v[i]);
      }
      const double energy =
          ComputeKineticEnergy(card.full, v) + ComputeSpringEnergy(card.full, x) + ComputeBendingEnergy(card.full, x);
      return std::tuple(momentum, angular, energy);
    };
    const auto [momentum, angular, energy] = measure();
    StepAlone(card, 0.1 / card.angularFrequency, 2000, x, v);
    const auto [momentumAfter, angularAfter, energyAfter] = measure();
    EXPECT_LT((momentumAfter - momentum).norm(), 1e-10 * momentum.norm());
    EXPECT_LT((angularAfter - angular).norm(), 1e-5 * momentum.norm());
    if (dampingRatio > 0) {
      EXPECT_LT(energyAfter, 0.9999 * energy);
    } else {
      EXPECT_NEAR(energyAfter, energy, 1e-5 * energy);
    }
  }
}

// A sheet held in a clamp and let go in the engine's own stepping droops by ρ g L⁴/(8 D), as far as that is small.
TEST(Bending, AClampedSheetDroopsAsInTheory) {
  ClothDefinition definition = MakeCard({5, 9}, Pinned::kClamp, 0.1);
  definition.spacing = 0.2;
  definition.material.drag = 3;
  const double length = 7.5 * definition.spacing;
  const double load = 9.81 * FindDensity(definition);
  const double droop = 0.03 * length;
  definition.bendStiffness = load * std::pow(length, 4) / 8 / droop;
  definition.material.stiffness = 3000;
  ASSERT_TRUE(ValidateCloth(definition).empty()) << ValidateCloth(definition)[0].range;
  for (const Precision precision : {Precision::kSingle, Precision::kDouble}) {
    World world({{0, 0, -9.81}, 1.0 / 60, precision, 1});
    const BodyId id = world.AddBody(world.AddBlueprint(MakeCloth(definition)), Vector3d(0, 0, 5));
    for (int tick = 0; tick < 600; ++tick) world.Step();
    double sum = 0;  // it still swings a little
    for (int tick = 0; tick < 300; ++tick) {
      world.Step();
      const std::vector<Vector3d> x = ListPositions(world, id);
      sum += x.front().z() - x.back().z();
    }
    EXPECT_NEAR(sum / 300, droop, 0.02 * droop);
  }
}

}  // namespace
}  // namespace wobble::physics
