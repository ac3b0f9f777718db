// Bodies that rest on one another do not intersect: contacts between skins push from a gap on (skins/skin_gap.h).
#include "server/physics/skins/skin_gap.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "server/physics/shapes/cloth.h"
#include "server/physics/skins/body_contact_update.h"
#include "server/physics/skins/body_contact_view.h"
#include "server/physics/world.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

LatticeDefinition MakeCube(double size, int cells, double youngModulus) {
  LatticeDefinition cube = MakeJellyCube(0.3);
  cube.cells = {cells, cells, cells};
  cube.cellSize = size / cells;
  cube.youngModulus = youngModulus;
  return cube;
}

double FindLowest(const World& world, BodyId id) {
  double lowest = 1e9;
  for (const Vector3d& x : ListPositions(world, id)) lowest = std::min(lowest, x.z());
  return lowest;
}

double FindHighest(const World& world, BodyId id) {
  double highest = -1e9;
  for (const Vector3d& x : ListPositions(world, id)) highest = std::max(highest, x.z());
  return highest;
}

int StepUntilAsleep(World& world, BodyId id, int most) {
  int ticks = 0;
  for (; ticks < most && !world.ReadBody(id).asleep; ++ticks) world.Step();
  return ticks;
}

// A cube of 0.6 m on the ground, body 1, and one above it, body 2.
void AddTwoCubes(World& world, const Vector3d& upper) {
  world.AddBlueprint(MakeLattice(MakeCube(0.6, 3, 60000)));
  world.AddObstacle(Obstacle{});
  world.AddBody(0, Vector3d(0, 0, 0.3));
  world.AddBody(0, upper);
}

constexpr BodyId kLower = 1;
constexpr BodyId kUpper = 2;

TEST(SkinGap, IsAShareOfTheSmallerBodyAndThereForAllSkins) {
  const Blueprint small = MakeLattice(MakeCube(0.2, 2, 20000));
  const Blueprint large = MakeLattice(MakeCube(4, 2, 20000));
  EXPECT_EQ(FindFullGap(small, large), kGapShare * small.size);
  EXPECT_EQ(FindFullGap(large, large), kLargestGap);
  EXPECT_GT(FindFullGap(small, MakeCloth(ClothDefinition{})), 0);
}

TEST(SkinGap, ABodyThatFallsOnAnotherRestsAboveIt) {
  World world(WorldSettings{});
  AddTwoCubes(world, Vector3d(0.05, 0.02, 0.95));
  EXPECT_LT(StepUntilAsleep(world, kUpper, 1200), 1200);
  const double apart = FindLowest(world, kUpper) - FindHighest(world, kLower);
  EXPECT_GT(apart, 0);
  EXPECT_LT(apart, kLargestGap);
}

// The middle of the cube dents the ball, whose valleys the cube's vertices hover over.
TEST(SkinGap, ACubeInTheDentOfABallFallsAsleep) {
  World world(WorldSettings{});
  BallDefinition ball;
  ball.material.gas = 330;
  world.AddBlueprint(MakeBall(ball));
  LatticeDefinition cube = MakeCube(0.3, 2, 60000);
  world.AddBlueprint(MakeLattice(cube));
  for (const double side : {-1.0, 1.0}) {
    world.AddObstacle({.normal = Vector3d(side, 0, 0), .offset = -0.6});
    world.AddObstacle({.normal = Vector3d(0, side, 0), .offset = -0.6});
  }
  world.AddObstacle(Obstacle{});
  world.AddBody(0, Vector3d(0, 0, 0.6));
  const BodyId lying = world.AddBody(1, Vector3d(0, 0, 1.5));
  EXPECT_LT(StepUntilAsleep(world, lying, 3600), 3600);
}

// Put down face on face: nothing is thrown, and after a second the bodies are apart.
TEST(SkinGap, WidensSlowlyBetweenBodiesThatArePutDownFlush) {
  World world(WorldSettings{});
  AddTwoCubes(world, Vector3d(0.1, 0.05, 0.9));
  double highest = 0;
  for (int tick = 0; tick < 120; ++tick) {
    world.Step();
    highest = std::max(highest, world.FindCentre(world.ReadBody(kUpper)).z());
  }
  EXPECT_LT(highest, 0.9 + kLargestGap);
  EXPECT_GT(FindLowest(world, kUpper), FindHighest(world, kLower));
}

// A stored world is refused when a gap is more than the largest, be it by a rounding.
TEST(SkinGap, EndsExactlyAtTheFullOne) {
  PairSides<float> sides;
  sides[0].resize(1);
  const auto widen = [&](double full, double& gap) { FindWithGap(full, 1.0 / 60, gap, sides, [](std::size_t) {}); };
  for (int i = 0; i < 1000; ++i) {
    double gap = kLargestGap * i / 1000;
    while (gap < kLargestGap) widen(kLargestGap, gap);
    ASSERT_EQ(gap, kLargestGap) << i;
    widen(0.5 * kLargestGap, gap);
    ASSERT_EQ(gap, kLargestGap) << "of a body that has become smaller";
  }
}

TEST(SkinGap, IsStored) {
  World world(WorldSettings{});
  AddTwoCubes(world, Vector3d(0.1, 0.05, 0.9));
  for (int tick = 0; tick < 20; ++tick) world.Step();
  World copy(WorldSettings{});
  AddTwoCubes(copy, Vector3d(0.1, 0.05, 0.9));
  ASSERT_EQ(copy.Restore(world.Capture()), "");
  for (int tick = 0; tick < 20; ++tick) {
    world.Step();
    copy.Step();
  }
  EXPECT_EQ(ListPositions(world, kUpper), ListPositions(copy, kUpper));
}

// Two faces that meet in a valley along the y axis, and a vertex that hovers h above the left one and comes to the
// right one, which looks another way. Its height must not become slip, which friction would pull back.
TEST(SkinGap, TheHeightAboveAFaceIsNoSlipAlongTheNext) {
  const std::vector<Vector3d> x{{0, -1, 0}, {0, 1, 0}, {-1, 0, 0.3}, {1, 0, 0.3}};
  const std::vector<Face> faces{{0, 1, 2}, {0, 3, 1}};
  const Topology topology = MakeTopology(faces, x.size());
  const Skin<double> skin{.faces = faces, .topology = &topology, .x = std::span<const Vector3d>(x), .offset = 0.01};
  const Vector3d p(0, 0, 0.008);
  const std::vector<Vector3d> vertex{p};
  const Meeting<double> meeting{.x = std::span<const Vector3d>(vertex),
                                .v = std::span<const Vector3d>(vertex),
                                .shares = {},
                                .skin = skin,
                                .skinV = std::span<const Vector3d>(x)};
  const FacePoint<double> left = FindFacePoint(skin, 0, p);
  const BodyContact<double> contact{.face = 0, .phase = ContactPhase::kTouching, .foot = left.weights};
  EXPECT_LT(FindSlip(meeting, contact, p, left).norm(), 1e-12);
  EXPECT_LT(FindSlip(meeting, contact, p, FindFacePoint(skin, 1, p)).norm(), 1e-12);
}

// Beside a closed body's face the gap fades out, and from both sides of an edge alike.
TEST(SkinGap, FadesOutBesideAnEdgeAlikeFromBothFaces) {
  const std::vector<Vector3d> x{{0, -1, 0}, {0, 1, 0}, {-1, 0, -1}, {1.5, 0, -1.5}};
  const std::vector<Face> faces{{0, 1, 2}, {0, 3, 1}};
  const Topology topology = MakeTopology(faces, x.size());
  const Skin<double> skin{
      .faces = faces, .topology = &topology, .x = std::span<const Vector3d>(x), .offset = 0.01, .fadingGap = 0.01};
  const auto findDistance = [&](std::uint16_t face, const Vector3d& p) {
    FacePoint<double> at = FindFacePoint(skin, face, p);
    FadeGap(skin, at);
    return at.distance;
  };
  const Vector3d above(0, 0, 0.008);
  EXPECT_NEAR(findDistance(0, above), findDistance(1, above), 1e-12);
  EXPECT_NEAR(findDistance(0, above), 0.008 - 0.01, 1e-12) << "the edge is 8 mm away";
  const Vector3d farBeside(0.1, 0, 0.3);  // of the left face
  EXPECT_NEAR(findDistance(0, farBeside), 0.2 / std::sqrt(2.0), 1e-12);
}

}  // namespace
}  // namespace wobble::physics
