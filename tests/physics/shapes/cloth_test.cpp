// Cloths: the forces that hold them up, how they fall, and how they tear.
#include "server/physics/shapes/cloth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "server/physics/methods/runge_kutta.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/shapes/tear.h"
#include "server/physics/world.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

ClothDefinition MakeDefinition(Pinned pinned) {
  ClothDefinition definition;
  definition.points = {9, 7};
  definition.pinned = pinned;
  return definition;
}

// The forces that hold the fixed vertices, N.
Vector3d FindHold(const Blueprint& cloth, const Body& body) {
  const auto& state = std::get<State<double>>(body.state);
  const std::vector<Vector3d> v(state.positions.size(), Vector3d::Zero());
  std::vector<Vector3d> forces(v.size());
  ComputeForces<double>(cloth.full, Load<double>{}, {}, {}, state.positions, v, forces);
  Vector3d hold = Vector3d::Zero();
  for (const std::uint16_t vertex : cloth.full.fixed) hold -= forces[vertex];
  return hold;
}

TEST(Cloth, WhatIsPinnedCarriesItsWeight) {
  for (const auto& [pinned, orientation, count] : {std::tuple{Pinned::kCorners, Orientation::kHorizontal, 4U},
                                                   std::tuple{Pinned::kTopCorners, Orientation::kVertical, 2U},
                                                   std::tuple{Pinned::kEdge, Orientation::kVertical, 9U},
                                                   std::tuple{Pinned::kFrame, Orientation::kHorizontal, 28U},
                                                   std::tuple{Pinned::kClamp, Orientation::kHorizontal, 18U}}) {
    ClothDefinition definition = MakeDefinition(pinned);
    definition.orientation = orientation;
    definition.material.dampingRatio = 1;
    definition.material.drag = 5;
    ASSERT_TRUE(ValidateCloth(definition).empty()) << ValidateCloth(definition)[0].range;
    const Blueprint cloth = MakeCloth(definition);
    ASSERT_EQ(cloth.full.fixed.size(), count);
    World world({{0, 0, -9.81}, 1.0 / 60, Precision::kDouble, 1});
    world.AddBlueprint(cloth);
    const BodyId id = world.AddBody(0, Vector3d(1, 2, 3));
    for (int tick = 0; tick < 1800; ++tick) world.Step();
    double carried = cloth.totalMass;
    for (const std::uint16_t vertex : cloth.full.fixed) carried -= cloth.full.masses[vertex];
    const Vector3d hold = FindHold(cloth, world.ReadBody(id));
    EXPECT_NEAR(hold.z(), 9.81 * carried, 0.005 * 9.81 * carried) << count;
    EXPECT_LT(std::hypot(hold.x(), hold.y()), 0.01 * hold.z());
    const auto& state = std::get<State<double>>(world.ReadBody(id).state);
    for (const std::uint16_t vertex : cloth.full.fixed) {
      EXPECT_LT((state.origin + state.positions[vertex] - Vector3d(1, 2, 3) - cloth.rest[vertex]).norm(), 1e-12);
    }
  }
}

// A flat, free cloth soon falls at √(m g / (½ρC A)) in still air, and with g without air.
TEST(Cloth, FallsAtTheSpeedThatDragLeavesIt) {
  ClothDefinition definition = MakeDefinition(Pinned::kNone);
  definition.orientation = Orientation::kHorizontal;
  definition.material.drag = 0.6;
  const Blueprint cloth = MakeCloth(definition);
  World world({{0, 0, -9.81}, 1.0 / 60, Precision::kDouble, 1});
  world.AddBlueprint(cloth);
  const BodyId id = world.AddBody(0, Vector3d(0, 0, 100));
  for (int tick = 0; tick < 360; ++tick) world.Step();
  const double area = 0.8 * 0.6;
  const auto& state = std::get<State<double>>(world.ReadBody(id).state);
  const double speed = -FindMeanVelocity(cloth, state).z();
  EXPECT_NEAR(speed, std::sqrt(definition.material.mass * 9.81 / (0.6 * area)), 0.02 * speed);
}

TEST(Cloth, EverySideOfAFaceHasASpring) {
  const Blueprint cloth = MakeCloth(MakeDefinition(Pinned::kEdge));
  ASSERT_EQ(cloth.full.faces.size(), 2U * 8 * 6);
  std::set<std::array<std::uint32_t, 2>> springs;
  for (const Spring<double>& spring : cloth.full.springs) {
    springs.insert({std::min(spring.a, spring.b), std::max(spring.a, spring.b)});
  }
  EXPECT_EQ(springs.size(), cloth.full.springs.size()) << "none twice";
  for (const Face& face : cloth.full.faces) {
    for (std::size_t side = 0; side < 3; ++side) {
      const std::uint32_t a = face[side];
      const std::uint32_t b = face[(side + 1) % 3];
      EXPECT_TRUE(springs.contains({std::min(a, b), std::max(a, b)}));
    }
  }
}

TEST(Cloth, AWiderOneWeighsTheSameASquareMetreAndIsNoFaster) {
  ClothDefinition narrow = MakeDefinition(Pinned::kNone);
  ClothDefinition wide = narrow;
  wide.points = {17, 13};
  wide.material.mass = 4 * narrow.material.mass;
  const Blueprint small = MakeCloth(narrow);
  const Blueprint large = MakeCloth(wide);
  EXPECT_DOUBLE_EQ(*std::ranges::max_element(small.full.masses), *std::ranges::max_element(large.full.masses));
  EXPECT_NEAR(large.totalMass, 4 * small.totalMass, 1e-12);
  EXPECT_NEAR(large.angularFrequency, small.angularFrequency, 0.05 * small.angularFrequency);
}

TEST(Cloth, ALargeOneIsBuilt) {
  ClothDefinition definition;
  definition.points = {100, 100};
  definition.spacing = 0.05;
  definition.material.mass = 10;
  definition.pinned = Pinned::kEdge;
  const Blueprint cloth = MakeCloth(definition);
  EXPECT_EQ(cloth.rest.size(), 10000U);
  EXPECT_TRUE(IsSlowEnough(cloth));
}

TEST(Cloth, ValidateNamesFieldValueAndRange) {
  ClothDefinition definition;
  EXPECT_TRUE(ValidateCloth(definition).empty());
  definition.points = {1, 200};
  definition.spacing = 0;
  definition.shear = 0;
  definition.tearStretch = 0.9;
  definition.material.drag = -1;
  const auto errors = ValidateCloth(definition);
  ASSERT_EQ(errors.size(), 5U);
  EXPECT_EQ(errors[0].field, "points");
  EXPECT_EQ(errors[0].value, "[1, 200]");
  EXPECT_EQ(errors[3].field, "tear_stretch");
  EXPECT_EQ(errors[3].range, "0 (never) or 1.05 to 10");
  EXPECT_EQ(errors[4].field, "drag");
}

TEST(Cloth, ValidateRefusesABendStiffnessThatIsTooFast) {
  ClothDefinition definition;
  definition.bendStiffness = -1;
  ASSERT_EQ(ValidateCloth(definition).size(), 1U);
  EXPECT_EQ(ValidateCloth(definition)[0].field, "bend_stiffness");
  EXPECT_EQ(ValidateCloth(definition)[0].range, "0 to 1e6 J");
  definition.bendStiffness = 0.5;
  EXPECT_TRUE(ValidateCloth(definition).empty());
  definition.bendStiffness = 50;
  ASSERT_EQ(ValidateCloth(definition).size(), 1U);
  EXPECT_EQ(ValidateCloth(definition)[0].field, "bend_stiffness");
  definition.material.stiffness = 1e6;  // at fault without hinges, too
  ASSERT_EQ(ValidateCloth(definition).size(), 1U);
  EXPECT_EQ(ValidateCloth(definition)[0].field, "stiffness");
}

TEST(Tear, SpringsThatAreTooLongTearOnceAndForGood) {
  ClothDefinition definition = MakeDefinition(Pinned::kEdge);
  definition.tearStretch = 1.5;
  const Blueprint cloth = MakeCloth(definition);
  State<double> state = MakeState<double>(cloth, Vector3d::Zero(), Vector3d::Zero());
  ASSERT_EQ(state.torn.size(), cloth.full.springs.size());
  const auto find = [&] { return FindTorn<double>(cloth.full, state.positions, state.torn); };
  EXPECT_EQ(find(), 0U);
  state.positions[31] += Vector3d(0, 0.14, 0);  // sides of 0.1 m become 0.172 m long
  std::vector<std::size_t> expected;
  for (std::size_t i = 0; i < cloth.full.springs.size(); ++i) {
    const Spring<double>& spring = cloth.full.springs[i];
    const bool touches = spring.a == 31 || spring.b == 31;
    if (touches && std::fabs(spring.restLength - 0.1) < 1e-9) expected.push_back(i);
  }
  EXPECT_EQ(expected.size(), 4U);
  EXPECT_EQ(find(), expected.size());
  for (const std::size_t i : expected) EXPECT_EQ(state.torn[i], 1) << i;
  state.positions[31] = cloth.rest[31];
  EXPECT_EQ(find(), 0U);
  EXPECT_EQ(std::ranges::count(state.torn, 1), static_cast<std::ptrdiff_t>(expected.size())) << "torn for good";
  State<double> whole = state;
  whole.torn.assign(whole.torn.size(), 0);
  EXPECT_NE(HashState(state, kHashSeed), HashState(whole, kHashSeed));
}

TEST(Tear, ABlueprintThatCannotTearNeverDoes) {
  const Blueprint cloth = MakeCloth(MakeDefinition(Pinned::kEdge));
  EXPECT_TRUE(MakeState<float>(cloth, Vector3d::Zero(), Vector3d::Zero()).torn.empty());
}

TEST(Tear, TheTornBlueprintHasTheSameForcesAndNoFacesAlongTears) {
  ClothDefinition definition = MakeDefinition(Pinned::kEdge);
  definition.tearStretch = 1.5;
  definition.material.drag = 0;
  const Blueprint cloth = MakeCloth(definition);
  std::vector<std::uint8_t> torn(cloth.full.springs.size(), 0);
  for (std::size_t i = 0; i < torn.size(); i += 11) torn[i] = 1;
  const Blueprint left = MakeTornBlueprint(cloth, torn);
  EXPECT_EQ(left.full.springs.size(), cloth.full.springs.size() - (torn.size() + 10) / 11);
  EXPECT_EQ(left.single.springs.size(), left.full.springs.size());
  EXPECT_EQ(left.full.fixed, cloth.full.fixed);
  EXPECT_EQ(left.angularFrequency, cloth.angularFrequency);
  EXPECT_EQ(left.topology.neighbours.size(), left.full.faces.size());
  EXPECT_EQ(left.single.faces, left.full.faces);
  // The forces are those of the whole cloth with these springs marked as torn.
  const std::vector<Vector3d> x = Deform(cloth.rest, 0.02);
  const std::vector<Vector3d> v = Deform(std::vector<Vector3d>(x.size(), Vector3d::Zero()), 1);
  std::vector<Vector3d> expected(x.size());
  std::vector<Vector3d> forces(x.size());
  Load<double> load;
  load.torn = torn;
  ComputeForces<double>(cloth.full, load, {}, {}, x, v, expected);
  ComputeForces<double>(left.full, Load<double>{}, {}, {}, x, v, forces);
  EXPECT_EQ(forces, expected);
  // A face is removed exactly if a spring along one of its sides is.
  std::set<std::array<std::uint32_t, 2>> whole;
  for (const Spring<double>& spring : left.full.springs) {
    whole.insert({std::min(spring.a, spring.b), std::max(spring.a, spring.b)});
  }
  std::vector<Face> faces;
  for (const Face& face : cloth.full.faces) {
    const auto holds = [&](std::size_t side) {
      const std::uint32_t a = face[side];
      const std::uint32_t b = face[(side + 1) % 3];
      return whole.contains({std::min(a, b), std::max(a, b)});
    };
    if (holds(0) && holds(1) && holds(2)) faces.push_back(face);
  }
  EXPECT_EQ(left.full.faces, faces);
  EXPECT_LT(faces.size(), cloth.full.faces.size());
}

// Along a row of three, two sides; of a square, four. A cut column takes every hinge that reaches across it.
TEST(Tear, HingesGoWithTheSidesThatTheyStandOn) {
  ClothDefinition definition = MakeDefinition(Pinned::kEdge);
  definition.bendStiffness = 0.1;
  const Blueprint cloth = MakeCloth(definition);
  EXPECT_EQ(cloth.full.hinges.size(), 7U * 7 + 9 * 5 + 8 * 6);
  std::vector<std::uint8_t> torn(cloth.full.springs.size(), 0);
  for (std::size_t i = 0; i < torn.size(); ++i) {  // between columns 3 and 4
    const Spring<double>& spring = cloth.full.springs[i];
    torn[i] = (spring.a % 9 < 4) != (spring.b % 9 < 4) ? 1 : 0;
  }
  const Blueprint left = MakeTornBlueprint(cloth, torn);
  EXPECT_EQ(left.full.hinges.size(), 5U * 7 + 9 * 5 + 7 * 6);
  EXPECT_EQ(left.single.hinges.size(), left.full.hinges.size());
  for (const Hinge<double>& hinge : left.full.hinges) EXPECT_EQ(hinge.vertices[0] % 9 < 4, hinge.vertices[3] % 9 < 4);
  torn.assign(torn.size(), 0);
  torn[0] = 1;  // one side: a hinge before it is not there, one behind it, and one square
  EXPECT_EQ(MakeTornBlueprint(cloth, torn).full.hinges.size(), cloth.full.hinges.size() - 2);
}

}  // namespace
}  // namespace wobble::physics
