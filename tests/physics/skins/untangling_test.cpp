// Skins in one another are pulled apart: the forces against the length of the contour, then in worlds.
#include "server/physics/skins/untangling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "server/physics/shapes/ball.h"
#include "server/physics/shapes/cloth.h"
#include "server/physics/shapes/lattice.h"
#include "server/physics/shapes/mesh.h"
#include "server/physics/world.h"
#include "tests/physics/bodies.h"

namespace wobble::physics {
namespace {

constexpr double kUntanglingTick = 1.0 / 60;

using Corners = std::array<Vector3d, 3>;

// Adds the points at which the sides of one triangle pass through another.
void AddPassages(const Corners& sides, const Corners& face, std::vector<Vector3d>& points) {
  const Vector3d normal = (face[1] - face[0]).cross(face[2] - face[0]);
  for (std::size_t i = 0; i < 3; ++i) {
    const Vector3d& begin = sides[i];
    const Vector3d& end = sides[(i + 1) % 3];
    const double over = (begin - face[0]).dot(normal);
    const double under = (end - face[0]).dot(normal);
    if (over * under >= 0) continue;
    const Vector3d at = begin + over / (over - under) * (end - begin);
    bool isInside = true;
    for (std::size_t j = 0; j < 3; ++j) {
      const Vector3d along = face[(j + 1) % 3] - face[j];
      isInside = isInside && along.cross(at - face[j]).dot(normal) > 0;
    }
    if (isInside) points.push_back(at);
  }
}

Corners CornersOf(const Face& face, const std::vector<Vector3d>& x) { return {x[face[0]], x[face[1]], x[face[2]]}; }

// Of the lines along which triangles of two skins intersect, m.
double FindContourLength(std::span<const Face> faces, const std::vector<Vector3d>& x, std::span<const Face> others,
                         const std::vector<Vector3d>& y) {
  double length = 0;
  for (const Face& face : faces) {
    for (const Face& other : others) {
      std::vector<Vector3d> ends;
      AddPassages(CornersOf(face, x), CornersOf(other, y), ends);
      AddPassages(CornersOf(other, y), CornersOf(face, x), ends);
      if (ends.size() == 2) length += (ends[0] - ends[1]).norm();
    }
  }
  return length;
}

Blueprint MakeSheet(int points) {
  ClothDefinition cloth{.points = {points, points}, .orientation = Orientation::kHorizontal};
  cloth.spacing = 0.9 / (points - 1);
  return MakeCloth(cloth);
}

Blueprint MakeSoftBall(int subdivisions) {
  BallDefinition ball;
  ball.subdivisions = subdivisions;
  return MakeBall(ball);
}

// A sheet through a ball, or another body.
class Untangling : public testing::Test {
 protected:
  struct Side {
    Blueprint blueprint;
    std::vector<Vector3d> x;
  };

  static void Set(Side& side, Blueprint blueprint, double roughness) {
    side.x = Deform(blueprint.rest, roughness);
    side.blueprint = std::move(blueprint);
  }
  [[nodiscard]] TangledSkin<double> See(const Side& side) const {
    return {.blueprint = &side.blueprint,
            .x = side.x,
            .bounds = MakeSurvey<double>(side.blueprint.full.masses, side.x, side.x).bounds,
            .velocity = &side == &first ? Vector3d(0, 0, approach) : Vector3d::Zero(),
            .agitation = agitation};
  }
  void Look() { Untangle<double>(See(first), See(second), shift, kUntanglingTick, scratch, tangle, pulls); }
  // The forces on all vertices, those of the first body before those of the second, N.
  [[nodiscard]] Eigen::VectorXd ListForces() const {
    const std::size_t count = first.x.size() + second.x.size();
    Eigen::VectorXd forces = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(3 * count));
    for (std::size_t side = 0; side < 2; ++side) {
      for (const VertexForce<double>& each : pulls[side]) {
        const std::size_t vertex = each.vertex + (side == 0 ? 0 : first.x.size());
        forces.segment<3>(static_cast<Eigen::Index>(3 * vertex)) += each.force;
      }
    }
    return forces;
  }
  [[nodiscard]] double FindLength() const {
    std::vector<Vector3d> y = second.x;
    for (Vector3d& at : y) at += shift;
    return FindContourLength(first.blueprint.full.faces, first.x, second.blueprint.full.faces, y);
  }

  Side first;
  Side second;
  Vector3d shift{0.03, -0.02, 0.15};
  double approach = 6;   // m/s; the tension acts at once
  double agitation = 0;  // m/s
  UntanglingScratch scratch;
  Tangle tangle;
  Pulls<double> pulls;
};

// Where no side passes through a face so flat that its leverage is bounded.
TEST_F(Untangling, IsTheGradientOfTheLengthOfTheContour) {
  shift.z() = 0.3;
  Set(first, MakeSoftBall(0), 0.02);
  Set(second, MakeSheet(4), 0.02);
  for (int tick = 0; tick < 10; ++tick) Look();  // until the tension is full
  const Eigen::VectorXd forces = ListForces();
  Eigen::VectorXd slope = Eigen::VectorXd::Zero(forces.size());
  ASSERT_GT(FindLength(), 1);
  for (Eigen::Index i = 0; i < slope.size(); ++i) {
    auto vertex = static_cast<std::size_t>(i / 3);
    Side& side = vertex < first.x.size() ? first : second;
    if (&side == &second) vertex -= first.x.size();
    double& coordinate = side.x[vertex][i % 3];
    const double before = coordinate;
    coordinate = before + 1e-7;
    const double more = FindLength();
    coordinate = before - 1e-7;
    slope[i] = (more - FindLength()) / 2e-7;
    coordinate = before;
  }
  const double tension = -forces.dot(slope) / slope.squaredNorm();
  EXPECT_LT((forces + tension * slope).norm(), 1e-7 * forces.norm());
  // Of the sheet, whose vertices are lighter, with the largest acceleration.
  EXPECT_NEAR(tension, 150 * second.blueprint.totalMass / 16, 1e-6 * tension);
}

TEST_F(Untangling, KeepsMomentumAndAngularMomentum) {
  Set(first, MakeSoftBall(1), 0.05);
  Set(second, MakeSheet(6), 0.05);
  for (int tick = 0; tick < 10; ++tick) Look();
  Vector3d sum = Vector3d::Zero();
  Vector3d torque = Vector3d::Zero();
  double most = 0;
  for (std::size_t side = 0; side < 2; ++side) {
    for (const VertexForce<double>& each : pulls[side]) {
      const Vector3d at = side == 0 ? first.x[each.vertex] : Vector3d(second.x[each.vertex] + shift);
      sum += each.force;
      torque += at.cross(each.force);
      most = std::max(most, each.force.norm());
    }
  }
  ASSERT_GT(most, 0);
  EXPECT_LT(sum.norm(), 1e-12 * most);
  EXPECT_LT(torque.norm(), 1e-12 * most);
}

// Forces that are constant through a tick would heat them.
TEST_F(Untangling, IsWeakWhereBodiesVibrate) {
  Set(first, MakeSoftBall(1), 0.05);
  Set(second, MakeSheet(6), 0.05);
  for (int tick = 0; tick < 10; ++tick) Look();
  const double calm = ListForces().norm();
  ASSERT_GT(calm, 0);
  agitation = 10;
  Look();
  EXPECT_NEAR(ListForces().norm(), calm / 2, 1e-9 * calm);
  agitation = 100;
  Look();
  EXPECT_LT(ListForces().norm(), calm / 100);
}

// Their contacts know inside from outside.
TEST_F(Untangling, WaitsForASecondWithTwoClosedBodies) {
  Set(first, MakeSoftBall(1), 0.02);
  Set(second, MakeSoftBall(1), 0.02);
  int waited = 0;
  for (; pulls[0].empty() && waited < 300; ++waited) Look();
  EXPECT_GE(waited, 60);
  EXPECT_LE(waited, 60 + kMostTicksUntilLook + 1);
  shift = Vector3d(0, 0, 3);
  Look();
  EXPECT_TRUE(pulls[0].empty() && pulls[1].empty());
  EXPECT_EQ(tangle.ticks, 0);
}

// What has met softly, and what is so fast that it may be nearly through, is left to contacts.
TEST_F(Untangling, WaitsWhereABodyMeetsASheetSoftlyOrFast) {
  Set(first, MakeSoftBall(1), 0.02);
  Set(second, MakeSheet(6), 0.02);
  for (const double speed : {0.0, 4.9, 10.1}) {
    approach = speed;
    tangle = {};
    int waited = 0;
    do Look();
    while (pulls[0].empty() && ++waited < 300);
    EXPECT_GE(waited, 60) << speed;
    EXPECT_LE(waited, 66) << speed;
  }
  approach = 5.1;
  tangle = {};
  Look();
  EXPECT_FALSE(pulls[0].empty());
}

// In a world without gravity; for how long their contour is still longer than 0 by the end of each tick, s.
double FindTimeInOneAnother(const std::array<Blueprint, 2>& bodies,
                            const std::array<std::vector<Vector3d>, 2>& places) {
  WorldSettings settings;
  settings.gravity = Vector3d::Zero();
  World world(settings);
  std::array<BodyId, 2> ids{};
  for (std::size_t i = 0; i < 2; ++i) ids[i] = world.AddBody(world.AddBlueprint(bodies[i]), places[i][0]);
  for (std::size_t i = 0; i < 2; ++i) {
    world.SetMotion(ids[i], places[i], std::vector<Vector3d>(places[i].size(), Vector3d::Zero()));
  }
  int last = 0;
  for (int tick = 1; tick <= 600; ++tick) {
    const StepReport report = world.Step();
    EXPECT_EQ(report.quarantined + report.nonFinite, 0U) << tick;
    const double length = FindContourLength(bodies[0].full.faces, ListPositions(world, ids[0]), bodies[1].full.faces,
                                            ListPositions(world, ids[1]));
    if (length > 0) last = tick;
  }
  return last * kUntanglingTick;
}

std::vector<Vector3d> PutUp(const Blueprint& body, const Eigen::Matrix3d& turn, const Vector3d& at) {
  std::vector<Vector3d> x;
  for (const Vector3d& rest : body.rest) x.push_back(turn * rest + at);
  return x;
}

TEST(UntanglingWorld, SheetsThatCrossComeApart) {
  const Blueprint sheet = MakeSheet(8);
  const Eigen::Matrix3d upright = Eigen::AngleAxisd(1.5, Vector3d(1, 0.1, 0.2).normalized()).toRotationMatrix();
  const double time = FindTimeInOneAnother({sheet, sheet}, {PutUp(sheet, Eigen::Matrix3d::Identity(), Vector3d::Zero()),
                                                            PutUp(sheet, upright, Vector3d(0.11, 0.23, 0.2))});
  EXPECT_GT(time, 0);
  EXPECT_LT(time, 3);
}

// Corners and edges are in one another so deep that contacts, which count that depth as given, exert no force.
TEST(UntanglingWorld, BlocksThatWerePutIntoOneAnotherComeApart) {
  LatticeDefinition block;
  block.cells = {2, 2, 2};
  const Blueprint body = MakeLattice(block);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.7, Vector3d(1, 0.5, 0.2).normalized()).toRotationMatrix();
  const double time = FindTimeInOneAnother({body, body}, {PutUp(body, Eigen::Matrix3d::Identity(), Vector3d::Zero()),
                                                          PutUp(body, turn, Vector3d(0.3, 0.1, 0.25))});
  EXPECT_GT(time, 0.5);
  EXPECT_LT(time, 5);
}

// The lower half of a ball of 42 vertices.
Blueprint MakeBowl() {
  const Icosphere sphere = MakeIcosphere(1);
  MeshDefinition bowl;
  std::vector<std::uint16_t> places(sphere.vertices.size(), kNoFace);
  for (const Face& face : sphere.faces) {
    double height = 0;
    for (const std::uint16_t corner : face) height += sphere.vertices[corner].z() / 3;
    if (height > 0) continue;
    Face kept{};
    for (std::size_t i = 0; i < 3; ++i) {
      std::uint16_t& place = places[face[i]];
      if (place == kNoFace) {
        place = static_cast<std::uint16_t>(bowl.vertices.size());
        bowl.vertices.push_back(0.4 * sphere.vertices[face[i]]);
      }
      kept[i] = place;
    }
    bowl.faces.push_back(kept);
  }
  bowl.material.mass = 15;
  bowl.material.stiffness = 1500;
  bowl.material.dampingRatio = 0.1;
  bowl.material.gas = 0;
  return MakeMesh(bowl);
}

// A hit at 12 m/s drives bowls through one another, and contacts remember the sides on which they were before.
TEST(UntanglingWorld, BowlsThatWereDrivenThroughOneAnotherComeApart) {
  const Blueprint bowl = MakeBowl();
  int late = 0;  // pairs that are in one another in the last second, at every fourth tick
  for (int trial = 0; trial < 4; ++trial) {
    World world{WorldSettings{}};
    world.AddObstacle(Obstacle{});
    const std::uint8_t blueprint = world.AddBlueprint(bowl);
    std::vector<BodyId> ids;
    for (int i = 0; i < 4; ++i) {
      const Vector3d place(0.07 * ((3 * i + trial) % 4), 0.05 * ((i + 2 * trial) % 3), 0.5 + 0.55 * i);
      ids.push_back(world.AddBody(blueprint, place, Vector3d(0, 0, -12)));
    }
    for (int tick = 0; tick < 240; ++tick) {
      const StepReport report = world.Step();
      EXPECT_EQ(report.quarantined + report.nonFinite, 0U) << trial << ' ' << tick;
      if (tick < 180 || tick % 4 != 0) continue;
      for (std::size_t i = 0; i < ids.size(); ++i) {
        for (std::size_t j = i + 1; j < ids.size(); ++j) {
          late += FindContourLength(bowl.full.faces, ListPositions(world, ids[i]), bowl.full.faces,
                                    ListPositions(world, ids[j])) > 0
                      ? 1
                      : 0;
        }
      }
    }
  }
  EXPECT_LT(late, 100) << "193 while contacts did not forget";
}

}  // namespace
}  // namespace wobble::physics
