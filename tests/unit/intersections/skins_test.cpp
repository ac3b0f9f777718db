// Counts of whole bodies, against each pair of triangles looked at by itself.
#include "tests/bench/intersections/skins.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "server/physics/shapes/ball.h"
#include "server/physics/shapes/cloth.h"
#include "server/physics/shapes/lattice.h"
#include "tests/bench/random.h"

namespace wobble::bench {
namespace {

using namespace physics;

// Every pair, no boxes.
std::size_t CountEveryPair(const TriangleSkin& a, const TriangleSkin& b, bool inPlane) {
  SignCounts counts;
  std::size_t found = 0;
  for (std::size_t i = 0; i < a.faces.size(); ++i) {
    for (std::size_t j = &a == &b ? i + 1 : 0; j < b.faces.size(); ++j) {
      const Face& f = a.faces[i];
      const Face& g = b.faces[j];
      const Crossing crossing = FindCrossing({&a.points[f[0]], &a.points[f[1]], &a.points[f[2]]},
                                             {&b.points[g[0]], &b.points[g[1]], &b.points[g[2]]}, counts);
      found += crossing == Crossing::kThrough || (inPlane && crossing == Crossing::kInPlane) ? 1 : 0;
    }
  }
  return found;
}

std::unique_ptr<World> MakeWorldOf(Blueprint blueprint, std::initializer_list<Vector3d> places) {
  auto world = std::make_unique<World>(WorldSettings{});
  world->AddBlueprint(std::move(blueprint));
  for (const Vector3d& place : places) world->AddBody(0, place);
  return world;
}

Blueprint MakeSizedBall(int subdivisions, double radius) {
  BallDefinition ball;
  ball.subdivisions = subdivisions;
  ball.radius = radius;
  return MakeBall(ball);
}

TEST(Skins, BodiesAtRestAndApartHaveNoIntersections) {
  const auto world = MakeWorldOf(MakeBall({}), {Vector3d(0, 0, 0), Vector3d(1.2, 0, 0), Vector3d(100.3, 7, 1)});
  const Intersections found = CountIntersections(*world);
  EXPECT_EQ(found.betweenFine + found.betweenOthers + found.within, 0U);
  EXPECT_EQ(found.vertices, 3 * 162U);
  EXPECT_EQ(found.fineVertices, found.vertices);
}

TEST(Skins, BallsThatOverlapIntersectAlongARing) {
  const auto world = MakeWorldOf(MakeBall({}), {Vector3d(0, 0, 0), Vector3d(0.8, 0.1, 0.05)});
  const Intersections found = CountIntersections(*world);
  const TriangleSkin a = MakeTriangleSkin(*world, world->Bodies()[0]);
  const TriangleSkin b = MakeTriangleSkin(*world, world->Bodies()[1]);
  EXPECT_GT(found.betweenFine, 20U);
  EXPECT_EQ(found.betweenFine, CountEveryPair(a, b, false));
  EXPECT_EQ(found.betweenOthers, 0U);
  EXPECT_EQ(found.within, 0U);
}

TEST(Skins, ABallWithinAnotherDoesNotTouchItsSkin) {
  World world{WorldSettings{}};
  world.AddBlueprint(MakeSizedBall(1, 1));
  world.AddBlueprint(MakeSizedBall(1, 0.3));
  world.AddBody(0, Vector3d::Zero());
  world.AddBody(1, Vector3d::Zero());
  EXPECT_EQ(CountIntersections(world).betweenOthers, 0U);
}

TEST(Skins, CoarseBodiesAreCountedByThemselves) {
  const auto world = MakeWorldOf(MakeSizedBall(1, 0.5), {Vector3d(0, 0, 0), Vector3d(0.8, 0.1, 0.05)});
  const Intersections found = CountIntersections(*world);
  EXPECT_EQ(found.betweenFine, 0U);
  EXPECT_GT(found.betweenOthers, 5U);
  EXPECT_EQ(found.fineVertices, 0U);
}

// Vertices thrown about at random: against the count without boxes, within and between.
TEST(Skins, BoxesLeaveNothingOut) {
  Random random(5);
  const auto world = MakeWorldOf(MakeSizedBall(1, 0.5), {Vector3d(50, 0, 0), Vector3d(50.4, 0.3, 0.1)});
  for (const Body& body : world->Bodies()) {
    std::vector<Vector3d> x;
    VisitVertices(body, [&](std::size_t, const Vector3d& p) { x.emplace_back(p + 0.4 * random.DrawDirection()); });
    world->SetMotion(body.id, x, std::vector<Vector3d>(x.size(), Vector3d::Zero()));
  }
  const TriangleSkin a = MakeTriangleSkin(*world, world->Bodies()[0]);
  const TriangleSkin b = MakeTriangleSkin(*world, world->Bodies()[1]);
  const Intersections found = CountIntersections(*world);
  EXPECT_GT(found.within, 50U);
  EXPECT_EQ(found.within, CountEveryPair(a, a, true) + CountEveryPair(b, b, true));
  EXPECT_GT(found.betweenOthers, 50U);
  EXPECT_EQ(found.betweenOthers, CountEveryPair(a, b, false));
}

// A vertex that is pulled through the opposite skin takes the five or six faces round it along.
TEST(Skins, ASkinThatPassesThroughItselfIsCounted) {
  const auto world = MakeWorldOf(MakeBall({}), {Vector3d::Zero()});
  std::vector<Vector3d> x;
  VisitVertices(world->Bodies()[0], [&](std::size_t, const Vector3d& p) { x.push_back(p); });
  EXPECT_EQ(CountIntersections(*world).within, 0U);
  x[0] = -1.2 * x[0];
  world->SetMotion(world->Bodies()[0].id, x, std::vector<Vector3d>(x.size(), Vector3d::Zero()));
  EXPECT_GE(CountIntersections(*world).within, 5U);
}

// A cloth that lies flat is all in one plane, and none of its faces lies upon another. Folded over a line of its grid,
// each face of one half lies upon one of the other; those along the fold share a side.
TEST(Skins, AClothFoldedFlatLiesUponItself) {
  ClothDefinition cloth;
  cloth.points = {5, 5};
  cloth.orientation = Orientation::kHorizontal;
  const auto world = MakeWorldOf(MakeCloth(cloth), {Vector3d::Zero()});
  EXPECT_EQ(CountIntersections(*world).within, 0U);
  std::vector<Vector3d> x;
  VisitVertices(world->Bodies()[0], [&](std::size_t, const Vector3d& p) { x.push_back(p); });
  for (Vector3d& p : x) p.x() = std::fabs(p.x());
  world->SetMotion(world->Bodies()[0].id, x, std::vector<Vector3d>(x.size(), Vector3d::Zero()));
  EXPECT_GE(CountIntersections(*world).within, 16U);
}

TEST(Skins, PlanarBodiesIntersectWhereTheyOverlap) {
  LatticeDefinition plate;
  plate.cells = {2, 0, 2};
  const auto apart = MakeWorldOf(MakeLattice(plate), {Vector3d(0, 0, 0), Vector3d(0.6, 0, 0)});
  EXPECT_EQ(CountIntersections(*apart).betweenOthers, 0U);
  const auto upon = MakeWorldOf(MakeLattice(plate), {Vector3d(0, 0, 0), Vector3d(0.3, 0, 0.1)});
  const Intersections found = CountIntersections(*upon);
  EXPECT_GT(found.betweenOthers, 4U);
  EXPECT_EQ(found.within, 0U);
  const auto beside = MakeWorldOf(MakeLattice(plate), {Vector3d(0, 0, 0), Vector3d(0.3, 0.01, 0.1)});
  EXPECT_EQ(CountIntersections(*beside).betweenOthers, 0U) << "in another plane";
}

// Cubes laid upon one another have faces in one plane, which is a touch; a hair deeper they intersect.
TEST(Skins, CubesThatLieUponOneAnotherTouch) {
  const double side = 0.75;
  for (const double depth : {0.0, 1e-6}) {
    const auto world = MakeWorldOf(MakeLattice({}), {Vector3d(0, 0, 0), Vector3d(0.125, 0.25, side)});
    std::vector<std::vector<Vector3d>> corners(2);
    for (std::size_t i = 0; i < 2; ++i) {
      VisitVertices(world->Bodies()[i], [&](std::size_t, const Vector3d& p) {
        // Sixteenths, so that both have the same height exactly.
        corners[i].emplace_back(std::round(16 * p.x()) / 16, std::round(16 * p.y()) / 16, std::round(16 * p.z()) / 16);
        if (i == 1) corners[i].back().z() -= depth;
      });
    }
    SignCounts counts;
    const std::vector<Face>& faces = world->Blueprints()[0].full.faces;
    const TriangleSkin below = MakeTriangleSkin(faces, Vector3d::Zero(), corners[0]);
    const TriangleSkin above = MakeTriangleSkin(faces, Vector3d::Zero(), corners[1]);
    const std::size_t found = CountBetween(below, above, counts);
    if (depth > 0) {
      EXPECT_GT(found, 0U);
    } else {
      EXPECT_EQ(found, 0U);
    }
  }
}

TEST(Skins, ABodyThatIsNotFiniteIsLeftOut) {
  const std::vector<Face> faces{{0, 1, 2}};
  const std::vector<Vector3d> x{Vector3d::Zero(), Vector3d(NAN, 0, 0), Vector3d(0, 1, 0)};
  EXPECT_TRUE(MakeTriangleSkin(faces, Vector3d::Zero(), x).faces.empty());
}

}  // namespace
}  // namespace wobble::bench
