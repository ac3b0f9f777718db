// When a body has lost its shape, and the law of the force that draws it back to it.
#include "server/physics/methods/recovery.h"

#include <gtest/gtest.h>

#include <numbers>

#include "server/physics/shapes/ring.h"
#include "tests/bench/random.h"
#include "tests/physics/bodies.h"
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

TEST(ShapeAim, TurningNumbersAreCounted) {
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

Blueprint MakeLayeredRing() {
  RingDefinition ring;
  ring.layers = 3;
  return MakeRing(ring);
}

std::vector<Blueprint> MakeAll() {
  return {MakeRingOf(24), MakeLayeredRing(), MakeLattice(MakeJellyCube()), MakeSolid(MakeSolidBox({2, 2, 2}, 0.3)),
          MakeOblong()};
}

TEST(ShapeAim, IsKeptByAnyMotionAndLostByBrokenStates) {
  for (const Blueprint& blueprint : MakeAll()) {
    bench::Random random(5);
    for (int trial = 0; trial < 20; ++trial) {
      Vector3d axis = random.DrawDirection();
      if (blueprint.full.planar) axis = Vector3d::UnitY();
      const Eigen::AngleAxisd turn(random.Draw(0, 6), axis);
      const Vector3d stretch = random.DrawWithin({0.6, 0.6, 0.6}, {1.6, 1.6, 1.6});
      Shape x = blueprint.rest;
      for (Vector3d& at : x) at = turn * at.cwiseProduct(stretch);
      EXPECT_FALSE(HasLostShape<double>(blueprint.full, x)) << blueprint.name;
    }
    if (blueprint.full.outline.size() == blueprint.rest.size()) {
      EXPECT_TRUE(HasLostShape<double>(blueprint.full, Wind(blueprint, 2, random)));
      EXPECT_TRUE(HasLostShape<double>(blueprint.full, Wind(blueprint, -1, random)));
      continue;
    }
    for (const Broken how : {Broken::kInsideOut, Broken::kRandom}) {
      EXPECT_TRUE(HasLostShape<double>(blueprint.full, Break(how, blueprint, random))) << blueprint.name;
    }
  }
}

// A wheel: the two ends of its axle, and its rim, which goes round so often.
constexpr int kSides = 10;
Shape MakeWheel(int turns) {
  Shape x{{0, 0, -1}, {0, 0, 1}};
  for (int i = 0; i < kSides; ++i) {
    const double angle = 0.1 + 2 * std::numbers::pi * turns * i / kSides;
    x.emplace_back(std::cos(angle), std::sin(angle), 0);
  }
  return x;
}
std::uint16_t FindOnRim(int at) { return static_cast<std::uint16_t>(2 + at % kSides); }

// Elements that go round an edge twice are all right side out.
TEST(ShapeAim, FindsElementsThatGoRoundTwice) {
  Coefficients<double> wheel;
  for (int i = 0; i < kSides; ++i) wheel.tetrahedra.push_back({.vertices = {0, 1, FindOnRim(i), FindOnRim(i + 1)}});
  EXPECT_FALSE(HasLostShape<double>(wheel, MakeWheel(1)));
  EXPECT_TRUE(HasLostShape<double>(wheel, MakeWheel(2)));
}

// Faces that go round the centre twice all look outward.
TEST(ShapeAim, FindsSkinsThatGoRoundTwice) {
  Coefficients<double> wheel;
  wheel.aim.rest = MakeWheel(1);
  for (int i = 0; i < kSides; ++i) {
    wheel.faces.push_back({1, FindOnRim(i), FindOnRim(i + 1)});
    wheel.faces.push_back({0, FindOnRim(i + 1), FindOnRim(i)});
  }
  EXPECT_FALSE(HasLostShape<double>(wheel, MakeWheel(1)));
  EXPECT_TRUE(HasLostShape<double>(wheel, MakeWheel(2)));
}

Shape FindForces(const Blueprint& blueprint, const Shape& x, const Shape& v) {
  Shape forces(x.size(), Vector3d::Zero());
  AddRecovery<double>(blueprint.full, {.fold = 0, .aim = 0.7}, x, v, forces);
  return forces;
}

TEST(ShapeAim, KeepsBothMomentaAndTakesEnergy) {
  for (const Blueprint& blueprint : MakeAll()) {
    bench::Random random(4);
    for (int trial = 0; trial < 20; ++trial) {
      const Shape x = Break(kAllBroken[trial % 4], blueprint, random);
      const Shape v = Break(Broken::kRandom, blueprint, random);
      const Shape still(x.size(), Vector3d::Zero());
      const Shape forces = FindForces(blueprint, x, v);
      const Shape elastic = FindForces(blueprint, x, still);
      Vector3d sum = Vector3d::Zero();
      Vector3d torque = Vector3d::Zero();
      double largest = 0;
      double power = 0;  // of the damping
      for (std::size_t i = 0; i < x.size(); ++i) {
        sum += forces[i];
        torque += x[i].cross(forces[i]);
        largest = std::max(largest, forces[i].norm());
        power += v[i].dot(forces[i] - elastic[i]);
      }
      const double rounding = 1e-12 * largest * static_cast<double>(x.size());
      EXPECT_LT(sum.norm(), rounding) << blueprint.name << trial;
      EXPECT_LT(torque.norm(), rounding) << blueprint.name << trial;
      EXPECT_LT(power, 0) << blueprint.name << trial;
    }
  }
}

TEST(ShapeAim, ForcesAreTheGradientOfTheEnergy) {
  constexpr double kStep = 1e-6;
  for (const Blueprint& blueprint : MakeAll()) {
    bench::Random random(6);
    Shape x = blueprint.rest;
    for (Vector3d& at : x) at += 0.4 * blueprint.reach * random.DrawWithin({-1, 0, -1}, {1, 0, 1});
    const Shape forces = FindForces(blueprint, x, Shape(x.size(), Vector3d::Zero()));
    double largest = 0;
    for (const Vector3d& force : forces) largest = std::max(largest, force.norm());
    ASSERT_GT(largest, 0);
    const auto energy = [&] { return ComputeRecoveryEnergy(blueprint.full, {.fold = 0, .aim = 0.7}, x); };
    for (std::size_t i = 0; i < x.size(); i += 5) {
      for (const int axis : {0, 2}) {
        const double at = x[i][axis];
        x[i][axis] = at + kStep;
        const double above = energy();
        x[i][axis] = at - kStep;
        const double below = energy();
        x[i][axis] = at;
        EXPECT_NEAR(forces[i][axis], (below - above) / (2 * kStep), 1e-5 * largest) << blueprint.name;
      }
    }
  }
}

TEST(ShapeAim, BringsBackARingThatGoesRoundMoreThanOnce) {
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
