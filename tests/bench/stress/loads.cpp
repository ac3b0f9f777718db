// Bodies lie in a world with gravity and a floor, except where they spin or snap back: there nothing else acts on them.
// A load goes by being removed, or where bodies press one another by gravity's end.
#include "tests/bench/stress/loads.h"

#include <algorithm>
#include <cmath>

#include "server/physics/shapes/cloth.h"
#include "server/physics/shapes/lattice.h"
#include "tests/bench/contact/bodies.h"

namespace wobble::bench {
namespace {

using namespace physics;

constexpr double kLoadTime = 2;   // s under a load
constexpr double kAfterTime = 2;  // s without it

WorldSettings MakeFreeSettings() {
  WorldSettings settings;
  settings.gravity = Vector3d::Zero();
  return settings;
}

// A plate that covers a body of this reach. Of a ring's and a planar body's plane it is a beam across.
Blueprint MakePlate(double mass, double reach) {
  LatticeDefinition plate;
  plate.name = "plate";
  plate.cells = {6, 6, 2};
  plate.cellSize = 0.6 * reach;
  plate.density = mass / (72 * std::pow(plate.cellSize, 3));
  plate.youngModulus = std::max(1000.0, 1000 * mass / reach / reach);
  plate.contactStiffness = 4 * plate.youngModulus * plate.cellSize;
  return MakeLattice(plate);
}

StressOutcome PlayUnder(const Blueprint& body, const Blueprint& load, double drop, const auto& duringLoad) {
  StressOutcome outcome;
  World world(WorldSettings{});
  world.AddBlueprint(body);
  world.AddBlueprint(load);
  world.AddObstacle({});
  const BodyId id = world.AddBody(0, Vector3d(0, 0, body.reach + 0.01));
  double top = 0;
  for (const Vector3d& at : body.rest) top = std::max(top, at.z());
  double bottom = 0;
  for (const Vector3d& at : load.rest) bottom = std::min(bottom, at.z());
  const BodyId loadId = world.AddBody(1, Vector3d(0, 0, body.reach + 0.01 + top - bottom + drop));
  for (int part = 0; part < 10; ++part) {
    PlayStress(world, kLoadTime / 10, outcome);
    duringLoad(world, id);
  }
  world.RemoveBody(loadId);
  PlayStress(world, kAfterTime, outcome);
  NoteInverted(world, outcome);
  return outcome;
}

StressOutcome PlayCrush(StressBody kind, Random& random) {
  const Blueprint body = MakeStressBody(kind);
  const Blueprint plate = MakePlate(body.totalMass * random.DrawMagnitude(10, 100), body.reach);
  return PlayUnder(body, plate, random.Draw(0.02, 1), [](World&, BodyId) {});
}

// The heavy one moves like the light one: it has a thousand times its stiffness and gas as well.
StressOutcome PlayMasses(StressBody kind, Random& random) {
  return PlayUnder(MakeStressBody(kind), MakeStressBody(kind, 1000), random.Draw(0.02, 1), [](World&, BodyId) {});
}

StressOutcome PlaySpin(StressBody kind, Random& random) {
  StressOutcome outcome;
  World world(MakeFreeSettings());
  const Blueprint body = MakeStressBody(kind);
  world.AddBlueprint(body);
  const BodyId id = world.AddBody(0, Vector3d::Zero());
  const Vector3d axis = body.full.planar ? Vector3d(Vector3d::UnitY()) : random.DrawDirection();
  const Vector3d turn = random.DrawMagnitude(10, 60) / body.reach * axis;
  std::vector<Vector3d> velocities;
  for (const Vector3d& at : body.rest) velocities.push_back(turn.cross(at));
  world.SetMotion(id, body.rest, velocities);
  PlayStress(world, kLoadTime + kAfterTime, outcome);
  NoteInverted(world, outcome);
  return outcome;
}

StressOutcome PlayStretch(StressBody kind, Random& random) {
  constexpr double kTimes = 5;
  StressOutcome outcome;
  World world(MakeFreeSettings());
  const Blueprint body = MakeStressBody(kind);
  world.AddBlueprint(body);
  const BodyId id = world.AddBody(0, Vector3d::Zero());
  Vector3d axis = random.DrawDirection();
  if (body.full.planar) axis = Vector3d(axis.x(), 0, axis.z() + 1e-3).normalized();
  const bool isAlong = random.Happens(0.7);
  std::vector<Vector3d> x;
  for (const Vector3d& at : body.rest) {
    x.push_back(isAlong ? Vector3d(at + (kTimes - 1) * axis.dot(at) * axis) : Vector3d(kTimes * at));
  }
  world.SetMotion(id, x, std::vector<Vector3d>(x.size(), Vector3d::Zero()));
  PlayStress(world, kLoadTime + kAfterTime, outcome);
  NoteInverted(world, outcome);
  return outcome;
}

// A sheet in a frame across a shaft. What is under it at the end has gone through.
StressOutcome PlayBag(StressBody kind, Random& random, bool quick) {
  StressOutcome outcome;
  World world(WorldSettings{});
  const Blueprint body = MakeStressBody(kind);
  const int side = quick ? 2 : 4;
  const double spacing = 2.1 * body.reach;
  const double half = 0.5 * side * spacing + 0.2;
  ClothDefinition bag{.points = {24, 24}, .orientation = Orientation::kHorizontal, .pinned = Pinned::kFrame};
  bag.spacing = 2 * half / 23;
  bag.material.mass = 0.1 * body.totalMass * side * side * side;
  bag.material.stiffness = 4 * 9.81 * body.totalMass * side * side * side / half;
  world.AddBlueprint(body);
  world.AddBlueprint(MakeCloth(bag));
  AddShaft(half, world);
  const BodyId bagId = world.AddBody(1, Vector3d::Zero());
  for (int i = 0; i < side * side * side; ++i) {
    const Vector3d place(i % side - (side - 1) / 2.0, i / side % side - (side - 1) / 2.0, i / side / side);
    const Vector3d aside = random.DrawWithin({-0.05, -0.05, 0}, {0.05, 0.05, 0});
    world.AddBody(0, spacing * place + aside + Vector3d(0, 0, body.reach + 0.05));
  }
  PlayStress(world, 1.5 * kLoadTime, outcome);
  double lowest = 0;
  for (const Vector3d& at : ReadPositions(world.ReadBody(bagId))) lowest = std::min(lowest, at.z());
  for (const Body& each : world.Bodies()) outcome.through += world.FindCentre(each).z() < lowest - 0.1 ? 1 : 0;
  world.SetGravity(Vector3d::Zero());
  PlayStress(world, kAfterTime, outcome);
  NoteInverted(world, outcome);
  return outcome;
}

// A triangle through the middle of the body, larger than it.
Blade DrawBlade(const World& world, BodyId id, Random& random) {
  const Body& body = world.ReadBody(id);
  const double reach = world.BlueprintOf(body).reach;
  const Vector3d aside = random.DrawDirection();
  const Vector3d middle = world.FindCentre(body) + random.Draw(0, 0.5) * reach * aside;
  const Vector3d normal = random.DrawDirection();
  const Vector3d across = normal.unitOrthogonal();
  const Vector3d other = normal.cross(across);
  return {middle + 8 * reach * across, middle + 8 * reach * (-0.5 * across + other),
          middle + 8 * reach * (-0.5 * across - other)};
}

StressOutcome PlayCut(StressBody kind, Random& random) {
  const auto cut = [&](World& world, BodyId id) { world.CutSprings(id, DrawBlade(world, id, random)); };
  if (kind == StressBody::kCloth) {
    ClothDefinition sheet{.points = {16, 16}, .orientation = Orientation::kHorizontal, .pinned = Pinned::kFrame};
    sheet.tearStretch = 2;
    return PlayUnder(MakeCloth(sheet), MakeStressBody(StressBody::kBall42), 0.02, cut);
  }
  const Blueprint body = MakeStressBody(kind);
  StressOutcome outcome =
      PlayUnder(body, MakePlate(body.totalMass * random.DrawMagnitude(3, 30), body.reach), 0.02, cut);
  outcome.folded = 0;  // a cell that is cut through has no volume to keep
  return outcome;
}

}  // namespace

const char* NameStressLoad(StressLoad load) {
  constexpr const char* kNames[] = {"crush", "spin", "stretch", "masses", "bag", "cut"};
  return kNames[static_cast<std::size_t>(load)];
}

bool IsLoadFor(StressLoad load, StressBody kind) {
  switch (load) {
    case StressLoad::kCut:
      return kind == StressBody::kLattice || kind == StressBody::kCloth || kind == StressBody::kGraph;
    case StressLoad::kBag:
      return kind != StressBody::kRing && kind != StressBody::kCloth;
    default:
      return true;
  }
}

bool IsQuick(StressLoad load, StressBody kind) { return load != StressLoad::kBag || kind == StressBody::kBall42; }

StressOutcome PlayLoad(StressLoad load, StressBody kind, std::uint64_t seed, bool quick) {
  Random random(seed);
  switch (load) {
    case StressLoad::kCrush:
      return PlayCrush(kind, random);
    case StressLoad::kSpin:
      return PlaySpin(kind, random);
    case StressLoad::kStretch:
      return PlayStretch(kind, random);
    case StressLoad::kMasses:
      return PlayMasses(kind, random);
    case StressLoad::kBag:
      return PlayBag(kind, random, quick);
    case StressLoad::kCut:
      break;
  }
  return PlayCut(kind, random);
}

}  // namespace wobble::bench
