// Contacts of a body with itself: the search against plain loops, then cloths, ropes and rings that fall onto
// themselves.
#include "server/physics/edges/self_contact.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "server/physics/energy.h"
#include "server/physics/shapes/cloth.h"
#include "server/physics/shapes/graph.h"
#include "server/physics/shapes/lattice.h"
#include "server/physics/shapes/pair.h"
#include "server/physics/shapes/ring.h"
#include "server/physics/world.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

Blueprint MakeStrip(int across, int along, Pinned pinned = Pinned::kNone) {
  ClothDefinition cloth;
  cloth.points = {across, along};
  cloth.spacing = 0.05;
  cloth.pinned = pinned;
  cloth.material.mass = 0.2;
  cloth.material.stiffness = 200;
  cloth.material.drag = 0;
  return MakeCloth(cloth);
}

// The distance of two of a body's edges that meet itself, m.
double FindDistance(const Blueprint& blueprint, const std::vector<Vector3d>& x, const EdgeEnds& pair) {
  const auto [a, b] = blueprint.selfEdges[pair[0]];
  const auto [c, d] = blueprint.selfEdges[pair[1]];
  return FindSegmentDistance({x[a], x[b]}, {x[c], x[d]});
}

// Those that may meet, as the header says.
std::vector<EdgeEnds> ListMeeting(const Blueprint& blueprint) {
  std::vector<EdgeEnds> meeting;
  const auto count = static_cast<std::uint16_t>(blueprint.selfEdges.size());
  for (std::uint16_t i = 0; i < count; ++i) {
    for (std::uint16_t j = i + 1; j < count; ++j) {
      const double apart = FindDistance(blueprint, blueprint.rest, {i, j});
      if (apart > kSelfApartShare * 2 * blueprint.selfRadius) meeting.push_back({i, j});
    }
  }
  return meeting;
}

// The least distance of any two that may meet over that at which they touch.
double FindLeastShare(const World& world, BodyId id, const std::vector<EdgeEnds>& meeting) {
  const Blueprint& blueprint = world.BlueprintOf(world.ReadBody(id));
  const std::vector<Vector3d> x = ListPositions(world, id);
  double least = 1e9;
  for (const EdgeEnds& pair : meeting) least = std::min(least, FindDistance(blueprint, x, pair));
  return least / (2 * blueprint.selfRadius);
}

// The least of FindLeastShare at the end of each of `ticks`, in none of which a body may be quarantined.
double PlayForLeastShare(World& world, BodyId id, const std::vector<EdgeEnds>& meeting, int ticks) {
  double least = 1e9;
  for (int tick = 0; tick < ticks; ++tick) {
    EXPECT_EQ(world.Step().quarantined, 0U) << tick;
    least = std::min(least, FindLeastShare(world, id, meeting));
  }
  return least;
}

TEST(SelfContact, TheSearchFindsWhatPlainLoopsFind) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> of(-1, 1);
  GraphDefinition rope;
  for (int i = 0; i < 20; ++i) rope.particles.push_back({.position = {0.2 * i, 0, 0}});
  for (int i = 0; i + 1 < 20; ++i) rope.springs.push_back({.a = i, .b = i + 1});
  for (const Blueprint& blueprint : {MakeStrip(12, 17), MakeGraph(rope)}) {
    ASSERT_GT(blueprint.selfRadius, 0);
    const std::vector<EdgeEnds> meeting = ListMeeting(blueprint);
    std::vector<EdgeContact<double>> contacts;
    SelfSearchScratch<double> scratch;
    const std::vector<Vector3d> v(blueprint.rest.size(), Vector3d::Zero());
    std::vector<EdgeEnds> listed;
    std::size_t found = 0;
    int tangled = 0;
    for (int trial = 0; trial < 40; ++trial) {
      // Drawn together until it is tangled. Now and then nothing is remembered.
      const double scale = 0.95 * std::pow(0.93, trial);
      if (trial % 5 == 0) contacts.clear();
      std::vector<Vector3d> x;
      for (const Vector3d& rest : blueprint.rest) {
        x.push_back(scale * rest + 0.01 * Vector3d(of(random), of(random), of(random)));
      }
      Survey<double> survey = MakeSurvey<double>(blueprint.full.masses, x, v);
      const SelfSearch<double> search{.rest = blueprint.rest, .bounds = survey.bounds, .margin = 0.02};
      const double touch = 2 * blueprint.selfRadius;
      const double room = FindSelfContacts<double>(blueprint.full.contact, MakeSelfMeeting<double>(blueprint, x, v),
                                                   search, contacts, scratch);
      std::vector<EdgeEnds> expected;
      double least = 1e9;
      bool isTangled = false;
      if (trial % 5 == 0) listed.clear();
      for (const EdgeEnds& pair : meeting) {
        const double distance = FindDistance(blueprint, x, pair);
        isTangled |= distance < touch / 2 && std::ranges::find(listed, pair) == listed.end();
        least = std::min(least, distance - touch);
        if (distance <= touch + search.margin) expected.push_back(pair);
      }
      if (isTangled) expected.clear();
      listed.clear();
      for (const auto& contact : contacts) listed.push_back({contact.first, contact.second});
      EXPECT_EQ(listed, expected) << blueprint.name << ' ' << trial;
      EXPECT_LE(room, least + 1e-12) << "no room is promised that there is not";
      found += listed.size();
      tangled += isTangled ? 1 : 0;
    }
    EXPECT_GT(found, 100U) << blueprint.name;
    EXPECT_GT(tangled, 3) << blueprint.name;
    EXPECT_LT(tangled, 25) << blueprint.name;
  }
}

TEST(SelfContact, AtRestNothingTouches) {
  for (const Blueprint& blueprint : {MakeStrip(8, 8), MakeLattice(LatticeDefinition{}), MakeRing(RingDefinition{})}) {
    for (const EdgeEnds& pair : ListMeeting(blueprint)) {
      ASSERT_GT(FindDistance(blueprint, blueprint.rest, pair), 2 * blueprint.selfRadius) << blueprint.name;
    }
  }
  EXPECT_EQ(MakePair(PairDefinition{}).selfRadius, 0) << "one rod has nothing to meet";
}

// A strip let fall on its end folds down layer by layer.
TEST(SelfContact, AClothThatFallsOntoItselfLiesInLayers) {
  World world(WorldSettings{});
  world.AddObstacle(Obstacle{});
  const BodyId id = world.AddBody(world.AddBlueprint(MakeStrip(6, 30)), Vector3d(0, 0, 0.8));
  const Blueprint& blueprint = world.BlueprintOf(world.ReadBody(id));
  const std::vector<EdgeEnds> meeting = ListMeeting(blueprint);
  std::vector<VertexForce<double>> bends;
  for (std::size_t i = 0; i < blueprint.rest.size(); ++i) {
    const Vector3d to(0, std::sin(12 * blueprint.rest[i].z()), 0);
    bends.push_back({.vertex = static_cast<std::uint16_t>(i), .force = 60 * blueprint.full.masses[i] * to});
  }
  world.PushVertices(id, bends);
  const double least = PlayForLeastShare(world, id, meeting, 240);
  EXPECT_GT(least, 0.72) << "nothing has passed: L/√3 is 0.72 d";
  EXPECT_LT(least, 0.99) << "it has lain on itself";
}

// In free flight, two ends of a strip thrown at one another: no momentum and no energy comes in.
TEST(SelfContact, KeepsMomentumAndGainsNoEnergy) {
  WorldSettings settings;
  settings.gravity.setZero();
  settings.precision = Precision::kDouble;
  World world(settings);
  const BodyId id = world.AddBody(world.AddBlueprint(MakeStrip(5, 25)), Vector3d::Zero());
  const Blueprint& blueprint = world.BlueprintOf(world.ReadBody(id));
  const std::vector<EdgeEnds> meeting = ListMeeting(blueprint);
  std::vector<VertexForce<double>> forces;
  for (std::size_t i = 0; i < blueprint.rest.size(); ++i) {
    const double end = blueprint.rest[i].z() / blueprint.reach;
    // Both ends go forward and inward, the middle back.
    const Vector3d to(0, 1.5 * end * end - 0.5, -2 * end);
    forces.push_back({.vertex = static_cast<std::uint16_t>(i), .force = 200 * blueprint.full.masses[i] * to});
  }
  const auto momentum = [&] {
    Eigen::Matrix<double, 6, 1> sum = Eigen::Matrix<double, 6, 1>::Zero();
    const auto& state = std::get<State<double>>(world.ReadBody(id).state);
    for (std::size_t i = 0; i < state.positions.size(); ++i) {
      const Vector3d p = blueprint.full.masses[i] * state.velocities[i];
      sum.head<3>() += p;
      sum.tail<3>() += (state.origin + state.positions[i]).cross(p);
    }
    return sum;
  };
  world.PushVertices(id, forces);
  world.Step();
  const Eigen::Matrix<double, 6, 1> before = momentum();
  const auto energy = [&] {
    std::vector<Vector3d> places;
    const Energy of = ComputeEnergy(world, world.ReadBody(id), places);
    return of.kinetic + of.springs;
  };
  const double begin = energy();
  double least = 1e9;
  for (int tick = 0; tick < 120; ++tick) {
    world.Step();
    least = std::min(least, FindLeastShare(world, id, meeting));
    EXPECT_LT(energy(), begin) << tick << ": dampers and contacts only take";
    EXPECT_LT((momentum() - before).norm(), 1e-9) << tick;
  }
  EXPECT_LT(least, 0.98) << "the ends have met";
  EXPECT_GT(least, 0.72);
}

// A body that has nothing near itself is stepped to the bit as if it could not meet itself.
TEST(SelfContact, WhatIsApartIsLeftAlone) {
  std::array<std::uint64_t, 2> hashes{};
  for (const bool meets : {true, false}) {
    World world(WorldSettings{});
    Blueprint curtain = MakeStrip(12, 12, Pinned::kEdge);
    if (!meets) curtain.selfRadius = 0;
    world.AddBody(world.AddBlueprint(std::move(curtain)), Vector3d::Zero(), Vector3d(0, 0.5, 0));
    for (int tick = 0; tick < 120; ++tick) world.Step();
    hashes[meets ? 1 : 0] = world.Hash();
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

// A rope let down lies in coils, one part on another.
TEST(SelfContact, ARopeLiesOnItself) {
  GraphDefinition rope;
  for (int i = 0; i < 40; ++i)
    rope.particles.push_back({.position = {0.02 * (i % 2), 0.01 * (i % 3), 0.1 * i}, .mass = 0.05});
  for (int i = 0; i + 1 < 40; ++i) rope.springs.push_back({.a = i, .b = i + 1, .stiffness = 2000, .damping = 1});
  World world(WorldSettings{});
  world.AddObstacle(Obstacle{});
  const BodyId id = world.AddBody(world.AddBlueprint(MakeGraph(rope)), Vector3d(0, 0, 2.1));
  const std::vector<EdgeEnds> meeting = ListMeeting(world.BlueprintOf(world.ReadBody(id)));
  const double least = PlayForLeastShare(world, id, meeting, 300);
  EXPECT_GT(least, 0.3) << "no part has passed through another";
  EXPECT_LT(least, 1) << "it has lain on itself";
}

}  // namespace
}  // namespace wobble::physics
