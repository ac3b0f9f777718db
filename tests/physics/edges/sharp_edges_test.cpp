// Sharp edges of skins meet one another: two edges that cross while no vertex is in a body (edges/edge_contact.h).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "server/physics/edges/edge_contact.h"
#include "server/physics/shapes/ball.h"
#include "server/physics/shapes/cloth.h"
#include "server/physics/shapes/mesh.h"
#include "server/physics/world.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

// A tetrahedron with an edge along x at its top, vertices 0 and 1, and one along y at its bottom, vertices 2 and 3. On
// top of one another, two of them meet by these edges alone, crosswise.
Blueprint MakeWedge() {
  MeshDefinition wedge;
  wedge.vertices = {{-0.5, 0, 0.35}, {0.5, 0, 0.35}, {0, -0.5, -0.35}, {0, 0.5, -0.35}};
  wedge.faces = {{0, 1, 3}, {1, 0, 2}, {2, 3, 1}, {3, 2, 0}};
  wedge.material.mass = 2;
  wedge.material.stiffness = 2000;
  wedge.material.gas = 50;
  wedge.material.friction = 0;
  return MakeMesh(wedge);
}

std::size_t CountSharp(const Blueprint& blueprint) { return blueprint.sharpEdges.size(); }

Blueprint MakeBallOf(int subdivisions) {
  BallDefinition ball;
  ball.subdivisions = subdivisions;
  return MakeBall(ball);
}

TEST(SharpEdges, AreWhereTheRestShapeBendsAndAtBorders) {
  EXPECT_EQ(CountSharp(MakeBallOf(0)), 30U) << "an icosahedron's edges";
  EXPECT_EQ(CountSharp(MakeBallOf(1)), 0U) << "42 vertices are round";
  EXPECT_EQ(CountSharp(MakeWedge()), 6U);
  const Blueprint cube = MakeLattice(MakeJellyCube());
  EXPECT_EQ(CountSharp(cube), 12U * 3U) << "three cells a side";
  const Blueprint cloth = MakeCloth(ClothDefinition{});
  const auto [across, along] = ClothDefinition{}.points;
  EXPECT_EQ(CountSharp(cloth), static_cast<std::size_t>(2 * (across - 1) + 2 * (along - 1)));
  for (const EdgeWings& wings : cloth.sharpWings) EXPECT_EQ(wings[0], wings[1]) << "a border has one face";
  for (const Blueprint* each : {&cube, &cloth}) {
    const std::set<EdgeEnds> once(each->sharpEdges.begin(), each->sharpEdges.end());
    EXPECT_EQ(once.size(), each->sharpEdges.size());
    ASSERT_EQ(each->sharpWings.size(), each->sharpEdges.size());
  }
}

// An open skin is touched from both sides, whichever way its faces are wound.
TEST(SharpEdges, AreRidgesOfOpenSkinsInBothWindings) {
  MeshDefinition roof;
  roof.vertices = {{-0.5, 0, 0.3}, {0.5, 0, 0.3}, {-0.5, -0.5, 0}, {0.5, -0.5, 0}, {-0.5, 0.5, 0}, {0.5, 0.5, 0}};
  roof.faces = {{0, 2, 3}, {0, 3, 1}, {0, 1, 5}, {0, 5, 4}};
  roof.material.gas = 0;
  for (int winding = 0; winding < 2; ++winding) {
    EXPECT_EQ(CountSharp(MakeMesh(roof)), 1U + 6U) << "the ridge and the border";
    for (Face& face : roof.faces) std::swap(face[1], face[2]);
  }
}

// Two wedges, the upper one's bottom edge `distance` above the lower one's top edge, in a gap of 1 cm.
struct TwoWedges {
  Blueprint blueprint = MakeWedge();
  std::vector<Vector3d> lower = blueprint.rest;
  std::vector<Vector3d> upper = blueprint.rest;
  std::vector<Vector3d> still = std::vector<Vector3d>(4, Vector3d::Zero());
  std::vector<Vector3d> velocities = still;  // of the upper one
  std::uint16_t top = FindEdge(0, 1);
  std::uint16_t bottom = FindEdge(2, 3);
  ContactParameters<double> parameters = blueprint.full.contact;
  EdgeContact<double> contact;

  explicit TwoWedges(double distance) {
    const double rise = lower[0].z() - upper[2].z() + distance;
    for (Vector3d& x : upper) x.z() += rise;
    contact = {.first = bottom, .second = top, .depth = 0.01 - distance, .normal = Vector3d::UnitZ()};
  }
  [[nodiscard]] std::uint16_t FindEdge(std::uint16_t a, std::uint16_t b) const {
    const auto& edges = blueprint.sharpEdges;
    const auto at = std::ranges::find_if(
        edges, [a, b](const EdgeEnds& e) { return std::min(e[0], e[1]) == a && std::max(e[0], e[1]) == b; });
    return static_cast<std::uint16_t>(at - edges.begin());
  }
  [[nodiscard]] EdgeMeeting<double> Meet() const {
    const auto describe = [this](const std::vector<Vector3d>& x, const std::vector<Vector3d>& v) {
      return EdgeMeeting<double>::Body{.edges = blueprint.sharpEdges,
                                       .x = x,
                                       .v = v,
                                       .shares = blueprint.full.contactShares,
                                       .wings = blueprint.sharpWings};
    };
    return {.first = describe(upper, velocities), .second = describe(lower, still), .radius = 0.01};
  }
  // On the upper wedge along z, N.
  [[nodiscard]] double FindLift() const {
    std::array<EdgeForce<double>, 1> forces;
    ComputeEdgeContacts<double>(parameters, Meet(), {&contact, 1}, forces);
    return forces[0].acts ? forces[0].forces[0].z() + forces[0].forces[1].z() : 0;
  }
  void Update() { UpdateEdgeContacts<double>(parameters, Meet(), 1e-3, {&contact, 1}); }
};

TEST(SharpEdges, PushFromTheGapOnAndFromBeyondTheAxis) {
  EXPECT_EQ(TwoWedges(0.02).FindLift(), 0) << "above the gap";
  const double near = TwoWedges(0.005).FindLift();
  EXPECT_GT(near, 0);
  EXPECT_GT(TwoWedges(-0.02).FindLift(), near) << "the upper edge is in the lower body";
  EXPECT_EQ(TwoWedges(-0.3).FindLift(), 0) << "vertices are behind faces by then";
}

// Faces that turn over within a substep change the sense at any depth. To push at once would be energy from nowhere: in
// a random world with torn cloth 43 bodies were quarantined for it.
TEST(SharpEdges, DoNotPushWhileTheSenseChanges) {
  TwoWedges two(-0.02);
  EXPECT_GT(two.FindLift(), 0);
  two.contact.normal = -two.contact.normal;
  EXPECT_EQ(two.FindLift(), 0) << "within the substep";
  two.Update();
  EXPECT_EQ(two.contact.phase, EdgePhase::kTurned);
  EXPECT_GT(two.contact.normal.z(), 0) << "what the faces say";
  two.Update();
  EXPECT_NE(two.contact.phase, EdgePhase::kTurned);
  EXPECT_NEAR(two.contact.depth + two.contact.leap, 0.03, 1e-5);
  EXPECT_LE(two.contact.depth, FindFreeDepth(two.parameters) + 1e-9);
}

// Beside an edge's end, or where a face is nearer, a vertex's own contact holds the body.
TEST(SharpEdges, AreTurnedWhereAnotherPartIsNearer) {
  TwoWedges beside(0.005);
  for (Vector3d& x : beside.upper) x.x() += 0.6;
  EXPECT_EQ(beside.FindLift(), 0);
  beside.Update();
  EXPECT_EQ(beside.contact.phase, EdgePhase::kTurned);

  // The lower wedge's faces at its top edge fold up: the edge becomes a valley.
  TwoWedges valley(0.005);
  for (const std::size_t vertex : {2U, 3U}) valley.lower[vertex].z() = valley.lower[0].z() + 0.3;
  EXPECT_EQ(valley.FindLift(), 0);
}

// Depth that is there when two edges turn out has been brought by nothing: it must not push.
TEST(SharpEdges, TurnOutWithoutAPush) {
  TwoWedges two(-0.02);
  two.contact.phase = EdgePhase::kTurned;
  two.contact.depth = 0;
  EXPECT_EQ(two.FindLift(), 0) << "within the substep";
  two.Update();
  EXPECT_NE(two.contact.phase, EdgePhase::kTurned);
  EXPECT_NEAR(two.contact.depth + two.contact.leap, 0.03, 1e-5);
  EXPECT_LE(two.contact.depth, FindFreeDepth(two.parameters) + 1e-9);

  // Nor at any speed: sheets of 1.8 MN/m that crossed at 9 m/s got 300 J by 6 mm.
  TwoWedges fast(-0.02);
  fast.contact.phase = EdgePhase::kTurned;
  fast.contact.depth = 0;
  for (Vector3d& v : fast.velocities) v = Vector3d(0, 0, -9);
  fast.Update();
  EXPECT_NE(fast.contact.phase, EdgePhase::kTurned);
  EXPECT_LE(fast.contact.depth, FindFreeDepth(fast.parameters) + 1e-9);
}

struct WedgeShot {
  double leastHeight = 1;  // of the flying wedge's bottom edge above the other's top edge, m
  double apart = 0;        // its centre above the other's at the end, m
};

// A wedge is shot down at another one in free space, edge on edge, beside the middle by `shift` m.
WedgeShot ShootWedge(double speed, double shift) {
  WorldSettings settings;
  settings.gravity = Vector3d::Zero();
  World world(settings);
  world.AddBlueprint(MakeWedge());
  const BodyId lower = world.AddBody(0, Vector3d::Zero());
  const BodyId upper = world.AddBody(0, Vector3d(shift, shift, 0.8), Vector3d(0, 0, -speed));
  WedgeShot shot;
  const int ticks = static_cast<int>(60 * (0.3 / speed + 0.3));
  for (int i = 0; i < ticks; ++i) {
    world.Step();
    const std::vector<Vector3d> below = ListPositions(world, lower);
    const std::vector<Vector3d> above = ListPositions(world, upper);
    shot.leastHeight = std::min(shot.leastHeight, (above[2] + above[3] - below[0] - below[1]).z() / 2);
  }
  shot.apart = world.FindCentre(world.ReadBody(upper)).z() - world.FindCentre(world.ReadBody(lower)).z();
  return shot;
}

// Before, no vertex met a face: the bodies went through one another at 3 m/s, and at 1 m/s they were 0.5 m deep after
// 0.6 s.
TEST(SharpEdges, CrosswiseDoNotPassThroughOneAnother) {
  for (const double speed : {1.0, 3.0, 8.0}) {
    for (const double shift : {0.0, 0.07}) {
      const WedgeShot shot = ShootWedge(speed, shift);
      EXPECT_GT(shot.leastHeight, -0.003 * speed) << speed << " m/s, " << shift << " m";
      EXPECT_GT(shot.apart, 0.7) << speed << " m/s, " << shift << " m";
    }
  }
}

}  // namespace
}  // namespace wobble::physics
