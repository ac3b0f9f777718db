#include "server/physics/skins/face_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "server/physics/shapes/ball.h"

namespace wobble::physics {
namespace {

// Points all round a ball at `radius`, so that none lies over an edge by symmetry.
std::vector<Vector3d> MakeProbes(double radius) {
  std::vector<Vector3d> probes;
  for (int i = 0; i < 200; ++i) {
    const double z = 1 - (2 * i + 1) / 200.0;
    const double angle = 2.399963 * i + 0.1;
    const double across = std::sqrt(1 - z * z);
    probes.push_back(radius * Vector3d(across * std::cos(angle), across * std::sin(angle), z));
  }
  return probes;
}

// The distance to the nearest of a fine grid of points on every face.
double FindDistanceByTrying(const Skin<double>& skin, const Vector3d& p) {
  double least = std::numeric_limits<double>::max();
  for (const Face& face : skin.faces) {
    const Vector3d& a = skin.x[face[0]];
    for (int i = 0; i <= 20; ++i) {
      for (int j = 0; i + j <= 20; ++j) {
        const Vector3d q = a + i / 20.0 * (skin.x[face[1]] - a) + j / 20.0 * (skin.x[face[2]] - a);
        least = std::min(least, (q - p).norm());
      }
    }
  }
  return least;
}

class FaceSearch : public testing::Test {
 protected:
  FaceSearch() : sphere(MakeIcosphere(2)), topology(MakeTopology(sphere.faces, sphere.vertices.size())) {}

  Skin<double> MakeSkin() const { return {sphere.faces, &topology, sphere.vertices}; }

  Icosphere sphere;
  Topology topology;
};

TEST_F(FaceSearch, NeighboursShareASideAndAreMutual) {
  ASSERT_EQ(topology.vertices.size(), 162U);
  for (std::size_t f = 0; f < sphere.faces.size(); ++f) {
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const std::uint16_t other = topology.neighbours[f][corner];
      ASSERT_NE(other, kNoFace);
      const Face& face = sphere.faces[other];
      for (const std::size_t end : {(corner + 1) % 3, (corner + 2) % 3}) {
        EXPECT_NE(std::find(face.begin(), face.end(), sphere.faces[f][end]), face.end());
      }
      const auto& back = topology.neighbours[other];
      EXPECT_NE(std::find(back.begin(), back.end(), f), back.end());
      const std::uint16_t across = topology.across[f][corner];
      EXPECT_NE(std::find(face.begin(), face.end(), across), face.end());
      EXPECT_EQ(std::find(sphere.faces[f].begin(), sphere.faces[f].end(), across), sphere.faces[f].end());
    }
  }
  EXPECT_EQ(topology.sides.size(), sphere.edges.size());
}

TEST_F(FaceSearch, ABorderHasNoNeighbour) {
  const std::vector<Face> sheet{{0, 1, 2}, {2, 1, 3}};
  const Topology open = MakeTopology(sheet, 5);
  EXPECT_EQ(open.neighbours[0], (std::array<std::uint16_t, 3>{1, kNoFace, kNoFace}));
  EXPECT_EQ(open.across[0], (std::array<std::uint16_t, 3>{3, 1, 2}));
  EXPECT_EQ(open.sides.size(), 5U);
  EXPECT_EQ(open.vertices, (std::vector<std::uint16_t>{0, 1, 2, 3}));
  EXPECT_EQ(open.RingOf(1).size(), 2U);
  EXPECT_TRUE(open.RingOf(4).empty());
}

TEST_F(FaceSearch, OnlyASheetIsOpen) {
  EXPECT_FALSE(topology.isOpen);
  EXPECT_TRUE(MakeTopology(std::vector<Face>{{0, 1, 2}, {2, 1, 3}}, 4).isOpen);
}

// Seen from behind, distance and normal change their sign and nothing else changes.
TEST_F(FaceSearch, TheOtherSideOfASurfaceIsItsMirrorImage) {
  Skin<double> skin = MakeSkin();
  const Vector3d p(0.3, 0.5, 1.1);
  const FacePoint<double> front = FindFacePoint(skin, 17, p);
  skin.side = -1;
  const FacePoint<double> back = FindFacePoint(skin, 17, p);
  EXPECT_EQ(back.distance, -front.distance);
  EXPECT_EQ(back.normal, Vector3d(-front.normal));
  EXPECT_EQ(back.weights, front.weights);
}

// The walk begins at the next face or at the far side of the ball.
TEST_F(FaceSearch, NearestFaceOfAPointOutsideIsTheNearestOfAll) {
  const Skin<double> skin = MakeSkin();
  for (const Vector3d& p : MakeProbes(1.2)) {
    const std::uint16_t start = static_cast<std::uint16_t>(std::fabs(p.x()) * 100);
    const FacePoint<double> at = FindNearestFace(skin, FindFacePoint(skin, start, p), p);
    EXPECT_GT(at.distance, 0);
    const Vector3d clamped = at.weights.cwiseMax(0) / at.weights.cwiseMax(0).sum();
    const Face& face = skin.faces[at.face];
    const Vector3d q = clamped[0] * skin.x[face[0]] + clamped[1] * skin.x[face[1]] + clamped[2] * skin.x[face[2]];
    EXPECT_NEAR((p - q).norm(), FindDistanceByTrying(skin, p), 2e-3);
  }
}

// On a crumpled skin: where a walk has ended, a walk that has seen nothing yet finds no nearer face either.
TEST_F(FaceSearch, AWalkThatBeginsWhereOneHasEndedStays) {
  for (std::size_t i = 0; i < sphere.vertices.size(); ++i) {
    const auto at = static_cast<double>(i);
    sphere.vertices[i] += 0.15 * Vector3d(std::sin(1.3 * at), std::cos(2.1 * at), std::sin(0.7 * at));
  }
  const Skin<double> skin = MakeSkin();
  int moved = 0;
  for (const double radius : {1.0, 1.2, 1.5}) {
    for (const Vector3d& p : MakeProbes(radius)) {
      const std::uint16_t start = static_cast<std::uint16_t>(std::fabs(p.x()) * 100);
      const FacePoint<double> at = FindNearestFace(skin, FindFacePoint(skin, start, p), p);
      moved += at.face != start ? 1 : 0;
      EXPECT_EQ(FindNearestFace(skin, at, p).face, at.face);
    }
  }
  EXPECT_GT(moved, 500);
}

TEST_F(FaceSearch, FootAndNormalLeadBackToThePoint) {
  const Skin<double> skin = MakeSkin();
  const Vector3d p(0.3, 0.5, 1.1);
  const FacePoint<double> at = FindFacePoint(skin, 17, p);
  const Face& face = skin.faces[17];
  Vector3d foot = Vector3d::Zero();
  for (std::size_t i = 0; i < 3; ++i) foot += at.weights[static_cast<Eigen::Index>(i)] * skin.x[face[i]];
  EXPECT_LT((foot + at.distance * at.normal - p).norm(), 1e-13);
}

// A point goes round the ball just below its skin: its face is always the one above it.
TEST_F(FaceSearch, APointInsideSlidesFromFaceToFace) {
  const Skin<double> skin = MakeSkin();
  std::uint16_t face =
      FindNearestFace(skin, FindFacePoint<double>(skin, 0, Vector3d(1.2, 0, 0)), Vector3d(1.2, 0, 0)).face;
  for (int i = 0; i < 1000; ++i) {
    const double angle = 0.0063 * i;
    const Vector3d p = 0.93 * Vector3d(std::cos(angle), std::sin(angle) * 0.8, std::sin(angle) * 0.6);
    const FacePoint<double> at = SlideToFace(skin, FindFacePoint(skin, face, p), p);
    face = at.face;
    EXPECT_LT(at.distance, 0);
    EXPECT_NEAR(-at.distance, FindDistanceByTrying(skin, p), 2e-3);
  }
}

// Between the top of a cube and its side the nearest face changes; the face that the point came in through does not.
TEST_F(FaceSearch, APointInACornerKeepsTheFaceItCameThrough) {
  const std::vector<Vector3d> x{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, -1}, {1, 1, -1}};
  const std::vector<Face> faces{{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}};  // top, and the side at x = 1
  const Topology sharp = MakeTopology(faces, x.size());
  const Skin<double> skin{faces, &sharp, x};
  EXPECT_EQ(
      SlideToFace(skin, FindFacePoint<double>(skin, 0, Vector3d(0.99, 0.3, -0.2)), Vector3d(0.99, 0.3, -0.2)).face, 0);
  EXPECT_EQ(
      SlideToFace(skin, FindFacePoint<double>(skin, 2, Vector3d(0.8, 0.3, -0.01)), Vector3d(0.8, 0.3, -0.01)).face, 3);
  EXPECT_GE(
      SlideToFace(skin, FindFacePoint<double>(skin, 0, Vector3d(1.01, 0.3, -0.2)), Vector3d(1.01, 0.3, -0.2)).face, 2);
}

// A vertex under the edge between the top of a cube and its side, nearer to the side: its own normal decides its face.
TEST_F(FaceSearch, AVertexTurnsToTheFaceThatLooksTowardsIt) {
  const std::vector<Vector3d> x{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {1, 0, -1}, {1, 1, -1}};
  const std::vector<Face> faces{{0, 1, 2}, {0, 2, 3}, {1, 4, 5}, {1, 5, 2}};  // top, and the side at x = 1
  const Topology sharp = MakeTopology(faces, x.size());
  const Skin<double> skin{faces, &sharp, x};
  const Vector3d p(0.999, 0.3, -0.004);
  const FacePoint<double> side = FindFacePoint<double>(skin, 3, p);
  const double edge = std::sqrt(0.5);
  const auto turn = [&](const Vector3d& at, const Vector3d& outward, double within) {
    return TurnToFacing<double>(skin, FindFacePoint<double>(skin, 3, at), at, outward, within).face;
  };
  EXPECT_TRUE(LooksAlong<double>(side, Vector3d(edge, 0, -edge)));
  EXPECT_FALSE(LooksAlong<double>(side, Vector3d(-edge, 0, -edge)));
  EXPECT_EQ(turn(p, Vector3d(edge, 0, -edge), 0.01), 0) << "an edge that lies on this edge";
  EXPECT_EQ(turn(p, Vector3d(edge, 0, -edge), 0.003), 3) << "too far from the top";
  EXPECT_EQ(turn(p, Vector3d(-1, 0, 0), 0.01), 3) << "came from the side";
  EXPECT_EQ(turn(p, Vector3d::Zero(), 0.01), 3) << "a sheet";
  EXPECT_EQ(turn(Vector3d(1, 0.3, 0), Vector3d(edge, 0, -edge), 0), 0) << "on the edge itself";
  EXPECT_EQ(turn(Vector3d(1.1, 0.3, -0.004), Vector3d(edge, 0, -edge), 0.01), 3) << "outside, beyond the edge";
}

TEST_F(FaceSearch, OutwardIsTheMeanNormalOfTheFacesRound) {
  const Skin<double> skin = MakeSkin();
  for (const std::uint16_t vertex : topology.vertices) {
    EXPECT_GT(FindOutward(skin, vertex).dot(sphere.vertices[vertex]), 0.99);
    EXPECT_NEAR(FindOutward(skin, vertex).norm(), 1, 1e-12);
  }
}

}  // namespace
}  // namespace wobble::physics
