#include "tests/bench/contact/insides.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "tests/bench/contact/bodies.h"

namespace wobble::bench {

using namespace physics;

namespace {

// Distance to a triangle: to its plane where the foot of the perpendicular lies inside, otherwise to its nearest side.
double FindDistanceToFace(const Vector3d& a, const Vector3d& b, const Vector3d& c, const Vector3d& p) {
  const Vector3d corners[] = {a, b, c};
  const Vector3d normal = (b - a).cross(c - a).normalized();
  bool inside = true;
  double least = std::numeric_limits<double>::max();
  for (int i = 0; i < 3; ++i) {
    const Vector3d& from = corners[i];
    const Vector3d side = corners[(i + 1) % 3] - from;
    inside = inside && normal.dot(side.cross(p - from)) >= 0;
    const double share = std::clamp(side.dot(p - from) / side.squaredNorm(), 0.0, 1.0);
    least = std::min(least, (p - from - share * side).norm());
  }
  return inside ? std::fabs(normal.dot(p - a)) : least;
}

double FindDepthUnderSurfaces(const World& world, const std::vector<Vector3d>& x) {
  double deepest = 0;
  for (const Obstacle& obstacle : world.Obstacles()) {
    const Surface<double> surface = MakeSurface<double>(obstacle, Vector3d::Zero());
    for (const Vector3d& p : x) deepest = std::max(deepest, -FindSurfacePoint(surface, p).distance);
  }
  return deepest;
}

bool IsClosed(const Blueprint& blueprint) { return blueprint.restVolume > 0 && !blueprint.full.planar; }

Box FindBoxRound(const std::vector<Vector3d>& x) {
  Box box{x[0], x[0]};
  for (const Vector3d& p : x) {
    box.low = box.low.cwiseMin(p);
    box.high = box.high.cwiseMax(p);
  }
  return box;
}

bool AreApart(const Box& a, const Box& b) {
  return (a.low.array() > b.high.array()).any() || (b.low.array() > a.high.array()).any();
}

}  // namespace

double FindWinding(const std::vector<Face>& faces, const std::vector<Vector3d>& x, const Vector3d& p) {
  double sum = 0;
  for (const Face& face : faces) {
    const Vector3d a = x[face[0]] - p;
    const Vector3d b = x[face[1]] - p;
    const Vector3d c = x[face[2]] - p;
    const double la = a.norm();
    const double lb = b.norm();
    const double lc = c.norm();
    sum += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return sum / (4 * std::numbers::pi);
}

double FindDistance(const Vector3d& p, const std::vector<Face>& faces, const std::vector<Vector3d>& x) {
  double least = std::numeric_limits<double>::max();
  for (const Face& face : faces) least = std::min(least, FindDistanceToFace(x[face[0]], x[face[1]], x[face[2]], p));
  return least;
}

double FindDeepestInside(const std::vector<Vector3d>& points, const std::vector<Face>& faces,
                         const std::vector<Vector3d>& x) {
  Vector3d low = x[0];
  Vector3d high = x[0];
  for (const Vector3d& p : x) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  double deepest = 0;
  for (const Vector3d& p : points) {
    if ((p.array() < low.array()).any() || (p.array() > high.array()).any()) continue;
    if (FindWinding(faces, x, p) < 0.5) continue;
    deepest = std::max(deepest, FindDistance(p, faces, x));
  }
  return deepest;
}

std::vector<float> ListDepths(const World& world) {
  std::vector<std::vector<Vector3d>> places;
  std::vector<Box> boxes;
  for (const Body& body : world.Bodies()) {
    places.push_back(ReadPositions(body));
    boxes.push_back(FindBoxRound(places.back()));
  }
  std::vector<float> depths;
  for (std::size_t i = 0; i < places.size(); ++i) {
    double deepest = FindDepthUnderSurfaces(world, places[i]);
    for (std::size_t j = 0; j < places.size(); ++j) {
      const Blueprint& other = world.BlueprintOf(world.Bodies()[j]);
      if (j == i || !IsClosed(other)) continue;
      if (AreApart(boxes[i], boxes[j])) continue;
      deepest = std::max(deepest, FindDeepestInside(places[i], other.full.faces, places[j]));
    }
    depths.push_back(static_cast<float>(deepest / world.BlueprintOf(world.Bodies()[i]).size));
  }
  return depths;
}

}  // namespace wobble::bench
