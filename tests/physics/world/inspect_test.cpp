// Inspected forces: each kind against theory, and their sum against the motion that a step computes.
#include "server/physics/inspect.h"
#include "server/physics/step/losses.h"

#include <gtest/gtest.h>

#include <numeric>

#include "server/physics/shapes/cloth.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/shapes/graph.h"
#include "server/physics/world.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

Vector3d AddUp(const std::vector<Vector3d>& forces) {
  return std::accumulate(forces.begin(), forces.end(), Vector3d(Vector3d::Zero()));
}

Vector3d AddKinds(const InspectedForces& found, std::size_t i) {
  return found.elastic[i] + found.damping[i] + found.gas[i] + found.weight[i] + found.contact[i] + found.other[i];
}

WorldSettings MakeExact() {
  WorldSettings settings;
  settings.precision = Precision::kDouble;
  return settings;
}

// The sum of the plain force terms and of losses on a body that touches no other, without weight and the player's
// moving, N.
std::vector<Vector3d> ComputePlainForces(const World& world, BodyId id) {
  const Body& body = world.ReadBody(id);
  const auto& state = std::get<State<double>>(body.state);
  Load<double> load;
  load.gasFactor = body.gasFactor;
  load.stiffnessFactor = body.stiffnessFactor;
  load.wind = world.Settings().wind;
  load.torn = state.torn;
  std::vector<Surface<double>> surfaces;
  for (const Obstacle& obstacle : world.Obstacles()) surfaces.push_back(MakeSurface<double>(obstacle, state.origin));
  std::vector<Vector3d> forces(state.positions.size());
  ComputeForces<double>(world.BlueprintOf(body).full, load, surfaces, state.contacts, state.positions, state.velocities,
                        forces);
  const double tick = world.Settings().tickDuration;
  State<double> slowed = state;
  std::vector<double> scratch;
  ApplyLosses<double>(world.BlueprintOf(body), surfaces, tick, scratch, slowed);
  for (std::size_t i = 0; i < forces.size(); ++i) {
    forces[i] += world.BlueprintOf(body).full.masses[i] / tick * (slowed.velocities[i] - state.velocities[i]);
  }
  return forces;
}

void ExpectPlainForces(const World& world, BodyId id) {
  const InspectedForces found = InspectForces(world, id);
  const std::vector<Vector3d> plain = ComputePlainForces(world, id);
  const Coefficients<double>& full = world.BlueprintOf(world.ReadBody(id)).full;
  ASSERT_EQ(found.accelerations.size(), plain.size());
  for (std::size_t i = 0; i < plain.size(); ++i) {
    const double scale = 1 + found.elastic[i].norm() + found.contact[i].norm();
    EXPECT_LT((AddKinds(found, i) - found.weight[i] - plain[i]).norm(), 1e-12 * scale) << i;
    EXPECT_LT((found.weight[i] - full.masses[i] * world.Settings().gravity).norm(), 1e-12);
    EXPECT_LT((found.accelerations[i] - full.inverseMasses[i] * AddKinds(found, i)).norm(),
              1e-12 * scale * full.inverseMasses[i] + 1e-15);
  }
}

// Compares the inspected accelerations with the change of velocity in 0.1 µs of a twin: within 1 µs an impact at 4 m/s
// changes its force by more than the bound. Another 0.1 µs before lets the contacts adapt to such short steps. allowed:
// error as a share of the largest acceleration.
void ExpectStepped(const World& world, double allowed = 1e-3) {
  WorldSettings settings = world.Settings();
  settings.precision = Precision::kDouble;
  settings.tickDuration = 1e-7;
  World twin(world, settings);
  twin.Step();
  std::vector<InspectedForces> found;
  std::vector<std::vector<Vector3d>> before;
  for (const Body& body : twin.Bodies()) {
    found.push_back(InspectForces(twin, body.id));
    before.push_back(std::get<State<double>>(body.state).velocities);
  }
  twin.Step();
  for (std::size_t k = 0; k < found.size(); ++k) {
    const auto& after = std::get<State<double>>(twin.Bodies()[k].state).velocities;
    double largest = 1;
    for (const Vector3d& a : found[k].accelerations) largest = std::max(largest, a.norm());
    for (std::size_t i = 0; i < after.size(); ++i) {
      const Vector3d stepped = (after[i] - before[k][i]) / settings.tickDuration;
      EXPECT_LT((found[k].accelerations[i] - stepped).norm(), allowed * largest) << k << ", " << i;
    }
  }
}

TEST(Inspect, ABallThatLandsIsWhatTheStepMakesOfIt) {
  World world(MakeExact());
  world.AddBlueprint(MakeBall(BallDefinition{}));
  world.AddObstacle(Obstacle{});
  const BodyId id = world.AddBody(0, Vector3d(0, 0, 1.2), Vector3d(1, 0, -3));
  bool touched = false;
  for (int tick = 0; tick < 60; ++tick) {
    world.Step();
    if (tick % 4 != 0) continue;
    ExpectPlainForces(world, id);
    ExpectStepped(world);
    const InspectedForces found = InspectForces(world, id);
    touched = touched || AddUp(found.contact).z() > 10;
    EXPECT_LT(AddUp(found.elastic).norm(), 1e-9) << "inner forces add up to none";
    EXPECT_LT(AddUp(found.damping).norm(), 1e-9);
    EXPECT_LT(AddUp(found.gas).norm(), 1e-9);
    EXPECT_EQ(AddUp(found.other).norm(), 0);
  }
  EXPECT_TRUE(touched);
}

TEST(Inspect, ABallAtRestIsCarried) {
  for (const ContactLaw law : {ContactLaw::kPenalty, ContactLaw::kMagnetic, ContactLaw::kBacktracking}) {
    World world(WorldSettings{});
    Blueprint ball = MakeBall(BallDefinition{});
    SetContactLaw(ball, law);
    world.AddBlueprint(ball);
    world.AddObstacle(Obstacle{});
    const BodyId id = world.AddBody(0, Vector3d(0, 0, 1));
    for (int tick = 0; tick < 3000 && !world.ReadBody(id).asleep; ++tick) world.Step();
    const InspectedForces found = InspectForces(world, id);
    const double weight = world.BlueprintOf(world.ReadBody(id)).totalMass * 9.81;
    EXPECT_NEAR(AddUp(found.weight).z(), -weight, 1e-3 * weight);
    EXPECT_NEAR(AddUp(found.contact).z(), weight, 0.02 * weight) << static_cast<int>(law);
  }
}

TEST(Inspect, TwoBallsPushOneAnotherAlike) {
  World world(MakeExact());
  world.AddBlueprint(MakeBall(BallDefinition{}));
  const BodyId first = world.AddBody(0, Vector3d(0, 0, 50), Vector3d(1, 0, 0));
  const BodyId second = world.AddBody(0, Vector3d(1.3, 0.1, 50.05), Vector3d(-2, 0, 0));
  double strongest = 0;
  for (int tick = 0; tick < 60; ++tick) {
    world.Step();
    const Vector3d push = AddUp(InspectForces(world, first).contact);
    EXPECT_LT((push + AddUp(InspectForces(world, second).contact)).norm(), 1e-9) << "action and reaction";
    strongest = std::max(strongest, push.norm());
    if (tick % 5 == 0) ExpectStepped(world);
  }
  EXPECT_GT(strongest, 10);
}

TEST(Inspect, APileIsWhatTheStepMakesOfIt) {
  World world(MakeExact());
  world.AddBlueprint(MakeBall(BallDefinition{}));
  world.AddBlueprint(MakeLattice(MakeJellyCube(0.2)));
  world.AddObstacle(Obstacle{});
  for (int i = 0; i < 6; ++i) {
    world.AddBody(static_cast<std::uint8_t>(i % 2), Vector3d(0.3 * (i % 2), 0.05 * i, 0.8 + 0.9 * i));
  }
  for (int tick = 0; tick < 120; ++tick) {
    world.Step();
    if (tick % 20 == 0) ExpectStepped(world);
  }
}

TEST(Inspect, SolidsThatFallOnOneAnotherAreWhatTheStepMakesOfThem) {
  World world(MakeExact());
  world.AddBlueprint(MakeSolid(MakeSolidBox({2, 2, 2}, 0.4)));
  world.AddObstacle(Obstacle{});
  for (int i = 0; i < 3; ++i) world.AddBody(0, Vector3d(0.1 * i, 0.05 * i, 0.4 + 0.6 * i));
  for (int tick = 0; tick < 60; ++tick) {
    world.Step();
    if (tick % 15 == 0) ExpectStepped(world);
  }
}

// Where cores have met (skins/core_contact.h).
TEST(Inspect, BallsThatAreShotIntoOneAnotherAreWhatTheStepMakesOfThem) {
  WorldSettings settings = MakeExact();
  settings.gravity = Vector3d::Zero();
  settings.tickDuration /= 32;
  World world(settings);
  world.AddBlueprint(MakeBall(BallDefinition{}));
  const BodyId first = world.AddBody(0, Vector3d(-0.6, 0, 0), Vector3d(40, 0, 0));
  const BodyId second = world.AddBody(0, Vector3d(0.6, 0.02, 0), Vector3d(-40, 0, 0));
  const auto findDistance = [&] {
    return (world.FindCentre(world.ReadBody(first)) - world.FindCentre(world.ReadBody(second))).norm();
  };
  while (findDistance() > 0.3) world.Step();
  ExpectStepped(world);
  const Vector3d onFirst = AddUp(InspectForces(world, first).contact);
  EXPECT_LT(onFirst.x(), -1000);
  EXPECT_LT((onFirst + AddUp(InspectForces(world, second).contact)).norm(), 1e-9 * onFirst.norm());
}

TEST(Inspect, AClothInTheWindIsDragged) {
  WorldSettings settings = MakeExact();
  settings.wind = Vector3d(0, 6, 0);
  World world(settings);
  ClothDefinition cloth;
  cloth.points = {8, 8};
  cloth.pinned = Pinned::kTopCorners;
  cloth.bendStiffness = 0.2;
  world.AddBlueprint(MakeCloth(cloth));
  const BodyId id = world.AddBody(0, Vector3d(0, 0, 5));
  for (int tick = 0; tick < 30; ++tick) world.Step();
  ExpectPlainForces(world, id);
  ExpectStepped(world);
  const InspectedForces found = InspectForces(world, id);
  EXPECT_GT(AddUp(found.other).y(), 0.5);
  for (const std::uint16_t vertex : world.BlueprintOf(world.ReadBody(id)).full.fixed) {
    EXPECT_EQ(found.accelerations[vertex].norm(), 0);
    EXPECT_GT(found.elastic[vertex].norm(), 0.1) << "it is pulled at nevertheless";
  }
}

TEST(Inspect, KindsOfAGraphAreWhatFormulasSay) {
  World world(MakeExact());
  GraphDefinition graph;
  graph.particles = {{Vector3d(0, 0, 0), 2, false}, {Vector3d(1, 0, 0), 3, false}};
  graph.springs = {{0, 1, 100, 5, 1}};
  world.AddBlueprint(MakeGraph(graph));
  const BodyId id = world.AddBody(0, Vector3d(0, 0, 5));
  const std::vector<Vector3d> positions{{0, 0, 5}, {1.2, 0, 5}};
  const std::vector<Vector3d> velocities{{0, 0, 0}, {0.5, 2, 0}};
  world.SetMotion(id, positions, velocities);
  const InspectedForces found = InspectForces(world, id);
  EXPECT_LT((found.elastic[0] - Vector3d(20, 0, 0)).norm(), 1e-9);
  EXPECT_LT((found.elastic[1] - Vector3d(-20, 0, 0)).norm(), 1e-9);
  EXPECT_LT((found.damping[1] - Vector3d(-2.5, 0, 0)).norm(), 1e-9);
  EXPECT_LT((found.weight[1] - Vector3d(0, 0, -3 * 9.81)).norm(), 1e-9);
  EXPECT_LT((found.accelerations[1] - Vector3d(-22.5 / 3, 0, -9.81)).norm(), 1e-9);
  EXPECT_EQ(AddUp(found.gas).norm() + AddUp(found.contact).norm() + AddUp(found.other).norm(), 0);
  world.SetStiffnessFactor(2);
  for (int tick = 0; tick < 60; ++tick) world.Step();
  world.SetMotion(id, positions, velocities);
  EXPECT_LT((InspectForces(world, id).elastic[0] - Vector3d(40, 0, 0)).norm(), 1e-6) << "as stiff as it is";
  EXPECT_LT((InspectForces(world, id).damping[1] - Vector3d(-5, 0, 0)).norm(), 1e-6);
}

TEST(Inspect, OtherIsWhatPushesAndMoves) {
  World world(MakeExact());
  world.AddBlueprint(MakeLattice(MakeJellyCube(0.2)));
  const BodyId id = world.AddBody(0, Vector3d(0, 0, 50));
  Drive drive;
  drive.body = id;
  drive.vertices = {1, 2};
  drive.force = Vector3d(0, 0, 6);
  world.AddDrive(drive);
  Control control;
  control.moveX = 1;
  world.SetControl(id, control, ControlLimits{});
  const VertexForce<double> push{2, Vector3d(0, 4, 0)};
  world.PushVertices(id, {&push, 1});
  world.SetGravity(Vector3d(0, 0, -5));
  world.Step();
  world.SetGravity(Vector3d(0, 0, -9));
  const InspectedForces found = InspectForces(world, id);
  const Coefficients<double>& full = world.BlueprintOf(world.ReadBody(id)).full;
  for (std::size_t i = 0; i < full.masses.size(); ++i) {
    Vector3d expected = full.masses[i] * Vector3d(ControlLimits{}.acceleration, 0, 0);
    if (i == 1 || i == 2) expected += Vector3d(0, 0, 3);
    if (i == 2) expected += Vector3d(0, 4, 0);
    EXPECT_LT((found.other[i] - expected).norm(), 1e-9) << i;
    EXPECT_LT((found.weight[i] - full.masses[i] * Vector3d(0, 0, -5)).norm(), 1e-9) << "of the last step";
  }
  world.Step();
  EXPECT_LT((InspectForces(world, id).other[2] - InspectForces(world, id).other[1]).norm(), 0.2) << "pushed no more";
}

}  // namespace
}  // namespace wobble::physics
