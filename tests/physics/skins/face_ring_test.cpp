#include "server/physics/skins/face_ring.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "server/physics/shapes/ball.h"

namespace wobble::physics {
namespace {

// The face that FindFaceAround is to find, by plain code.
template <class Real>
FacePoint<Real> FindFaceOneByOne(const Skin<Real>& skin, std::uint16_t vertex, const Vector3<Real>& p) {
  FacePoint<Real> start;
  Real greatest = std::numeric_limits<Real>::lowest();
  for (const std::uint16_t face : skin.topology->RingOf(vertex)) {
    const FacePoint<Real> at = FindFacePoint(skin, face, p);
    const Real least = at.weights.minCoeff();
    if (start.face == kNoFace || least > greatest) {
      greatest = least;
      start = at;
    }
    if (least >= Real(0)) break;
  }
  return start;
}

template <class Real>
void ExpectTheSameBits(const FacePoint<Real>& a, const FacePoint<Real>& b) {
  EXPECT_EQ(a.face, b.face);
  EXPECT_EQ(a.distance, b.distance);
  EXPECT_EQ(a.normal, b.normal);
  EXPECT_EQ(a.weights, b.weights);
  EXPECT_EQ(a.doubleArea, b.doubleArea);
}

// All faces round the vertex, some at a time, against one by one. Returns how many faces have p in their box.
template <class Real>
int CompareSquares(const Skin<Real>& skin, std::uint16_t vertex, const Vector3<Real>& p) {
  int inside = 0;
  std::span<const std::uint16_t> faces = skin.topology->RingOf(vertex);
  for (std::size_t count = 0; !faces.empty(); faces = faces.subspan(count)) {
    const FaceRing<Real> ring(skin, faces, p);
    OfEachFace<Real> squares;
    OfEachFace<Real> boxes;
    ring.FindSquares(squares, boxes);
    count = ring.Count();
    EXPECT_EQ(count, std::min(faces.size(), kFacesAtOnce<Real>));
    for (std::size_t i = 0; i < count; ++i) {
      const Face& f = skin.faces[faces[i]];
      const Vector3<Real> low = skin.x[f[0]].cwiseMin(skin.x[f[1]]).cwiseMin(skin.x[f[2]]);
      const Vector3<Real> high = skin.x[f[0]].cwiseMax(skin.x[f[1]]).cwiseMax(skin.x[f[2]]);
      const Vector3<Real> beyond = (low - p).cwiseMax(p - high).cwiseMax(Real(0));
      EXPECT_EQ(squares[i], FindSquaredDistance(skin, faces[i], p));
      EXPECT_EQ(boxes[i], beyond[0] * beyond[0] + beyond[1] * beyond[1] + beyond[2] * beyond[2]);
      inside += boxes[i] == Real(0) ? 1 : 0;
    }
  }
  return inside;
}

// From all vertices to points near and far, inside and outside, from both sides. Returns how many were above the face.
template <class Real>
int CompareAll(const std::vector<Face>& faces, const std::vector<Vector3d>& vertices) {
  const Topology topology = MakeTopology(faces, vertices.size());
  std::vector<Vector3<Real>> x;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const auto at = static_cast<double>(i);
    const Vector3d shaken = vertices[i] + 0.02 * Vector3d(std::sin(1.3 * at), std::cos(2.1 * at), std::sin(0.7 * at));
    x.push_back(shaken.cast<Real>());
  }
  Skin<Real> skin{.faces = faces, .topology = &topology, .x = x};
  int above = 0;
  int inside = 0;
  for (const Real side : {Real(1), Real(-1)}) {
    skin.side = side;
    for (const std::uint16_t vertex : topology.vertices) {
      for (int i = 0; i < 12; ++i) {
        const Vector3d off(std::sin(3.1 * i + vertex), std::cos(1.7 * i), std::sin(0.9 * i + 1));
        const Vector3<Real> p = x[vertex] + (0.02 * (i + 1) * off).cast<Real>();
        const FacePoint<Real> at = FindFaceAround(skin, vertex, p);
        ExpectTheSameBits(at, FindFaceOneByOne(skin, vertex, p));
        inside += CompareSquares(skin, vertex, p);
        above += at.weights.minCoeff() >= Real(0) ? 1 : 0;
      }
    }
  }
  EXPECT_GT(inside, 10);
  return above;
}

// Twenty faces round the first vertex: more than a vector has lanes.
std::vector<Face> MakeFan(std::vector<Vector3d>& vertices) {
  constexpr std::uint16_t kBlades = 20;
  std::vector<Face> faces;
  vertices.assign(1, Vector3d(0, 0, 0.3));
  for (std::uint16_t i = 0; i < kBlades; ++i) {
    const double angle = 2 * M_PI * i / kBlades;
    vertices.emplace_back(std::cos(angle), std::sin(angle), 0);
    faces.push_back({0, static_cast<std::uint16_t>(1 + i), static_cast<std::uint16_t>(1 + (i + 1) % kBlades)});
  }
  return faces;
}

template <class Real>
class FaceRing : public testing::Test {};
using FaceRingPrecisions = testing::Types<float, double>;
TYPED_TEST_SUITE(FaceRing, FaceRingPrecisions);

TYPED_TEST(FaceRing, FindsWhatPlainCodeFindsOnABall) {
  const Icosphere sphere = MakeIcosphere(2);
  const int above = CompareAll<TypeParam>(sphere.faces, sphere.vertices);
  EXPECT_GT(above, 1000);
  EXPECT_LT(above, 162 * 24);
}

TYPED_TEST(FaceRing, FindsWhatPlainCodeFindsWhereTheRingIsLongOrShort) {
  std::vector<Vector3d> vertices;
  const std::vector<Face> fan = MakeFan(vertices);
  EXPECT_GT(CompareAll<TypeParam>(fan, vertices), 100);
}

}  // namespace
}  // namespace wobble::physics
