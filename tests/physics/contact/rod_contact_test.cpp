// Springs against obstacles that are smaller than they are long.
#include "server/physics/contact/rod_contact.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "server/physics/energy.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/shapes/graph.h"
#include "server/physics/shapes/pair.h"
#include "server/physics/world.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

constexpr double kHalfRod = 1;       // m
constexpr double kRodRadius = 0.03;  // m

struct NamedObstacle {
  const char* name;
  Obstacle obstacle;  // its top is at the origin; a rod along x reaches over it
};

Obstacle MakeRidge() {
  std::vector<double> heights;
  for (int row = 0; row < 21; ++row) {
    for (int column = 0; column < 21; ++column) heights.push_back(-2 * std::abs(0.25 * (column - 10)));
  }
  Obstacle ridge;
  ridge.kind = Obstacle::Kind::kHeightField;
  ridge.centre = {-2.5, -2.5, 0};
  ridge.field = MakeHeightField(21, 0.25, heights);
  ridge.centre.z() = -FindHeight(*ridge.field, 2.5, 2.5);
  return ridge;
}

std::vector<NamedObstacle> ListObstacles() {
  Obstacle sphere;
  sphere.kind = Obstacle::Kind::kSphere;
  sphere.centre = {0, 0, -0.3};
  sphere.radius = 0.3;
  Obstacle capsule = sphere;
  capsule.kind = Obstacle::Kind::kCapsule;
  capsule.centre = {0, -1, -0.2};
  capsule.end = {0, 1, -0.2};
  capsule.radius = 0.2;
  Obstacle wall;
  wall.kind = Obstacle::Kind::kBox;
  wall.centre = {0, 0, -2};
  wall.halfExtents = {0.1, 1, 2};
  return {{"sphere", sphere}, {"capsule", capsule}, {"wall", wall}, {"ridge", MakeRidge()}};
}

PairDefinition MakeLongPair() {
  PairDefinition pair;
  pair.length = 2 * kHalfRod;
  pair.radius = kRodRadius;
  pair.material.stiffness = 4000;
  pair.material.dampingRatio = 0.1;
  return pair;
}

// A chain of `links` springs along x.
GraphDefinition MakeChain(int links) {
  GraphDefinition chain;
  chain.radius = kRodRadius;
  for (int i = 0; i <= links; ++i)
    chain.particles.push_back({.position = {0.8 * (i - 0.5 * links), 0, 0}, .mass = 0.5});
  for (int i = 0; i < links; ++i) chain.springs.push_back({.a = i, .b = i + 1, .stiffness = 2000, .damping = 4});
  return chain;
}

// Drops the blueprint at `speed` onto the obstacle from 0.2 m above, and returns the height of its centre over the
// obstacle's top after `time`, m.
double DropOnto(const Blueprint& blueprint, const Obstacle& obstacle, double speed, double time,
                Precision precision = Precision::kSingle) {
  World world({.precision = precision});
  world.AddObstacle(obstacle);
  const BodyId body = world.AddBody(world.AddBlueprint(blueprint), {0, 0, 0.2}, {0, 0, -speed});
  while (static_cast<double>(world.Tick()) * world.Settings().tickDuration < time) {
    const StepReport report = world.Step();
    EXPECT_EQ(report.quarantined, 0U) << world.Tick();
  }
  return world.FindCentre(world.ReadBody(body)).z();
}

TEST(RodContact, ARodComesToRestOnWhatIsSmallerThanItIsLong) {
  for (const auto& [name, obstacle] : ListObstacles()) {
    for (const Precision precision : {Precision::kSingle, Precision::kDouble}) {
      const double height = DropOnto(MakePair(MakeLongPair()), obstacle, 0, 1, precision);
      EXPECT_GT(height, kRodRadius - 0.03) << name;
      EXPECT_LT(height, kRodRadius + 0.15) << name;
    }
  }
}

TEST(RodContact, ARodThatIsThrownDoesNotPass) {
  for (const auto& [name, obstacle] : ListObstacles()) {
    for (const double speed : {2.0, 5.0, 10.0}) {
      EXPECT_GT(DropOnto(MakePair(MakeLongPair()), obstacle, speed, 0.1), 0) << name << " at " << speed << " m/s";
    }
  }
}

TEST(RodContact, AChainHangsOverAWall) {
  const double hung = DropOnto(MakeGraph(MakeChain(3)), ListObstacles()[2].obstacle, 0, 1.5);
  EXPECT_LT(hung, -0.1) << "its ends hang down";
  EXPECT_GT(hung, -0.8) << "the middle link lies on the wall";
}

// A pair near an obstacle, by itself.
template <class Real>
struct LoneRod {
  Blueprint blueprint = MakePair(MakeLongPair());
  std::vector<Surface<Real>> surfaces;
  std::vector<NearRod> rods{{.surface = 0, .a = 0, .b = 1}};
  std::vector<Vector3<Real>> still{Vector3<Real>::Zero(), Vector3<Real>::Zero()};

  explicit LoneRod(const Obstacle& obstacle)
      : surfaces{MakeSurface<Real>(obstacle, Vector3d::Zero(), blueprint.rodRadius)} {}

  [[nodiscard]] const Coefficients<Real>& Body() const { return blueprint.Read<Real>(); }
  [[nodiscard]] std::vector<Vector3<Real>> FindForces(const std::vector<Vector3<Real>>& x) const {
    std::vector<Vector3<Real>> forces = still;
    AddRodContacts<Real>(Body(), surfaces, rods, x, still, forces);
    return forces;
  }
  [[nodiscard]] double FindEnergy(const std::vector<Vector3<Real>>& x) const {
    return ComputeRodContactEnergy<Real>(Body(), surfaces, rods, x);
  }
};

void ExpectGradient(const LoneRod<double>& rod, const std::vector<Vector3d>& x, const char* name) {
  constexpr double kStep = 1e-5;  // m; the search is right to 1e-5 of the length
  const std::vector<Vector3d> forces = rod.FindForces(x);
  for (std::size_t end = 0; end < 2; ++end) {
    for (int axis = 0; axis < 3; ++axis) {
      std::vector<Vector3d> more = x, less = x;
      more[end][axis] += kStep;
      less[end][axis] -= kStep;
      const double slope = (rod.FindEnergy(more) - rod.FindEnergy(less)) / (2 * kStep);
      EXPECT_NEAR(forces[end][axis], -slope, 1e-3 * (1 + forces[0].norm() + forces[1].norm())) << name;
    }
  }
}

// Where one end is in the obstacle, too: without its part of the force, energy came from nowhere. No deeper than a box
// is rounded, below which its normal jumps; nor flat on its top, where two edges hold the rod.
TEST(RodContact, TheForceIsTheGradientOfItsEnergy) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> within(-1, 1);
  for (const auto& [name, obstacle] : ListObstacles()) {
    if (obstacle.kind == Obstacle::Kind::kHeightField) continue;  // its distance is of first order
    const LoneRod<double> rod(obstacle);
    for (const Vector3d& end : {Vector3d(kHalfRod, 0, 0), Vector3d(0.1, 0, 0)}) {
      int pushed = 0;
      for (int trial = 0; trial < 200; ++trial) {
        std::vector<Vector3d> x{{-kHalfRod, 0, 0.05}, end};
        for (Vector3d& each : x) each += Vector3d(0.1 * within(random), 0.3 * within(random), 0.02 * within(random));
        pushed += rod.FindForces(x)[0].norm() > 1 ? 1 : 0;
        ExpectGradient(rod, x, name);
      }
      EXPECT_GT(pushed, 20) << name;
    }
  }
}

Obstacle MakeHills(std::mt19937& random) {
  std::uniform_real_distribution<double> height(-0.2, 0.2);
  std::vector<double> heights(81);
  for (double& each : heights) each = height(random);
  Obstacle hills;
  hills.kind = Obstacle::Kind::kHeightField;
  hills.centre = {-4, -4, 0};
  hills.field = MakeHeightField(9, 1, heights);
  return hills;
}

// The energy of a rod at the deepest of 4,001 points, J.
double FindEnergyByMany(const LoneRod<double>& rod, const std::vector<Vector3d>& x) {
  const auto read = [&](double s) {
    return FindSurfacePoint<double>(rod.surfaces[0], (1 - s) * x[0] + s * x[1]).distance;
  };
  double deepest = 0;
  for (int i = 1; i <= 4000; ++i) {
    if (read(i / 4000.0) < read(deepest)) deepest = i / 4000.0;
  }
  const double depth = std::min({0.0, read(0), read(1)}) - read(deepest);
  const double share = (1 - deepest) * rod.Body().contactShares[0] + deepest * rod.Body().contactShares[1];
  return share * ComputePenaltyEnergy(rod.Body().contact, depth);
}

// The distance from hills has several minima along a rod. Where another becomes the least, a search from too few
// samples comes to it late, and the depth leaps.
TEST(RodContact, FindsTheDeepestPlaceAmongHills) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> within(-2.5, 2.5);
  int pushed = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const LoneRod<double> rod(MakeHills(random));
    const double angle = within(random);
    const Vector3d middle(within(random), within(random), 0);
    const Vector3d half = kHalfRod * Vector3d(std::cos(angle), std::sin(angle), 0);
    std::vector<Vector3d> x{middle - half, middle + half};
    for (Vector3d& end : x) end.z() -= FindSurfacePoint<double>(rod.surfaces[0], end).distance;
    const double energy = FindEnergyByMany(rod, x);
    pushed += energy > 0.1 ? 1 : 0;
    EXPECT_NEAR(rod.FindEnergy(x), energy, 0.002 * energy + 1e-6) << trial;
  }
  EXPECT_GT(pushed, 100);
}

TEST(RodContact, WhatLiesOnAFlatSideIsHeldByItsEnds) {
  Obstacle box;
  box.kind = Obstacle::Kind::kBox;
  box.centre = {0, 0, -1};
  box.halfExtents = {3, 3, 1};
  const LoneRod<float> rod(box);
  for (const auto& force : rod.FindForces({{-1, 0, 0.01F}, {1, 0.5F, 0.013F}})) EXPECT_LT(force.norm(), 1e-3F);
}

// Links that are longer than a box is wide, sunk deep into its top as it is soft, slide off beside it.
TEST(RodContact, WhatSlidesOffABoxGetsNoEnergy) {
  GraphDefinition chain = MakeChain(3);
  chain.contactStiffness = 200;
  chain.friction = 0;
  chain.restitution = 1;
  for (GraphSpring& spring : chain.springs) spring.damping = 0;
  Obstacle box;
  box.kind = Obstacle::Kind::kBox;
  box.centre = {0, 0, -1};
  box.halfExtents = {1, 1, 1};
  for (const double slide : {1.0, 3.0, 6.0}) {
    World world({});
    world.AddObstacle(box);
    const BodyId id = world.AddBody(world.AddBlueprint(MakeGraph(chain)), {0, 0, 0.5}, {slide, 0.3, -4});
    std::vector<Vector3d> scratch;
    const auto findEnergy = [&] {
      const Energy energy = ComputeEnergy(world, world.ReadBody(id), scratch);
      return energy.kinetic + energy.gravity + energy.springs;
    };
    const double before = findEnergy();
    for (int tick = 0; tick < 180; ++tick) {
      const StepReport report = world.Step();
      ASSERT_EQ(report.quarantined, 0U) << slide << ' ' << tick;
      ASSERT_LT(findEnergy(), before + 1.0) << slide << ' ' << tick;
    }
  }
}

TEST(RodContact, TornSpringsAndPlanesAreNotListed) {
  const Blueprint blueprint = MakeGraph(MakeChain(3));
  const Obstacle plane;
  const std::vector<Surface<float>> surfaces{MakeSurface<float>(plane, Vector3d::Zero()),
                                             MakeSurface<float>(ListObstacles()[0].obstacle, Vector3d::Zero())};
  std::vector<Vector3f> x;
  for (const Vector3d& rest : blueprint.rest) x.push_back(rest.cast<float>());
  const std::vector<Vector3f> v(x.size(), Vector3f::Zero());
  const SurfaceSearch<float> search{.surfaces = surfaces,
                                    .x = x,
                                    .v = v,
                                    .survey = MakeSurvey<float>(blueprint.single.masses, x, v),
                                    .range = 0,
                                    .duration = 1.0F / 60};
  std::vector<NearRod> rods;
  FindNearRods<float>(blueprint.single, {}, search, rods);
  ASSERT_EQ(rods.size(), 1U) << "the link over the sphere";
  EXPECT_EQ(rods[0].surface, 1U);
  EXPECT_EQ(rods[0].a, 1);
  const std::vector<std::uint8_t> torn{0, 1, 0};
  FindNearRods<float>(blueprint.single, torn, search, rods);
  EXPECT_TRUE(rods.empty());
}

TEST(RodContact, PacksGiveTheSameMotionAsPlainCode) {
  const auto play = [](Integrator integrator, int leastSubsteps) {
    Blueprint blueprint = MakeGraph(MakeChain(3));
    SetIntegrator(blueprint, integrator);
    World world({.precision = Precision::kDouble, .leastSubsteps = leastSubsteps});
    world.AddObstacle(ListObstacles()[2].obstacle);
    const BodyId body = world.AddBody(world.AddBlueprint(blueprint), {0.1, 0, 0.1});
    for (int tick = 0; tick < 30; ++tick) (void)world.Step();
    return ListPositions(world, body);
  };
  const std::vector<Vector3d> packed = play(Integrator::kRungeKutta4, 64);
  const std::vector<Vector3d> plain = play(Integrator::kVelocityVerlet, 512);
  for (std::size_t i = 0; i < packed.size(); ++i) EXPECT_LT((packed[i] - plain[i]).norm(), 0.005) << i;
}

}  // namespace
}  // namespace wobble::physics
