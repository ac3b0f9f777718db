// States of a body that no motion can have brought: how they come, and what becomes of them.
#pragma once

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "server/physics/methods/forces.h"
#include "server/physics/world.h"
#include "tests/bench/random.h"

namespace wobble::physics {

enum class Broken {
  kFlattened,  // to a hundredth, along any axis
  kInsideOut,  // mirrored
  kFolded,     // one half over onto the other
  kRandom,     // each vertex anywhere in a cube as large as the body
};
inline constexpr Broken kAllBroken[] = {Broken::kFlattened, Broken::kInsideOut, Broken::kFolded, Broken::kRandom};

// A planar body stays in its plane.
inline std::vector<Vector3d> Break(Broken how, const Blueprint& blueprint, bench::Random& random) {
  Vector3d axis = random.DrawDirection();
  if (blueprint.full.planar) axis = Vector3d(axis.x(), 0, axis.z() + 1e-3).normalized();
  std::vector<Vector3d> x = blueprint.rest;
  for (Vector3d& p : x) {
    const double along = axis.dot(p);
    if (how == Broken::kFlattened) p -= 0.99 * along * axis;
    if (how == Broken::kInsideOut) p -= 2 * along * axis;
    if (how == Broken::kFolded && along < 0) p -= 1.9 * along * axis;
    if (how != Broken::kRandom) continue;
    for (int i = 0; i < 3; ++i) p[i] = blueprint.full.planar && i == 1 ? 0 : random.Draw(-1, 1) * blueprint.reach;
  }
  return x;
}

// RMS distance between two shapes, one turned and moved as it fits best (Kabsch 1976), m.
inline double FindShapeDistance(std::span<const Vector3d> x, std::span<const Vector3d> other) {
  const auto count = static_cast<double>(x.size());
  Vector3d centre = Vector3d::Zero();
  Vector3d otherCentre = Vector3d::Zero();
  for (std::size_t i = 0; i < x.size(); ++i) {
    centre += x[i] / count;
    otherCentre += other[i] / count;
  }
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (std::size_t i = 0; i < x.size(); ++i) covariance += (x[i] - centre) * (other[i] - otherCentre).transpose();
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d flip = Eigen::Matrix3d::Identity();
  flip(2, 2) = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  const Eigen::Matrix3d turn = svd.matrixU() * flip * svd.matrixV().transpose();
  double squares = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    squares += (x[i] - centre - turn * (other[i] - otherCentre)).squaredNorm();
  }
  return std::sqrt(squares / count);
}

struct Recovery {
  // Distance of the shape from that of a body that was never broken, of the body's size: the least in the last half
  // second. Both lie on the ground, so both are flatter by their weight; the broken one still breathes. Not that at the
  // very end: balls that turn out are thrown up by 5 m and land two seconds later, a tenth of their size high.
  double shape = 0;
  double speed = 0;         // of the centre, the largest on the way, m/s
  std::uint32_t reset = 0;  // times that the body was put back

  // A body that is still folded in half is off by 0.6, one that is inside out by more than 1, a ring that keeps a loop
  // by 0.3 to 0.9. Rings that have been thrown up and spin or swing are off by up to 0.3.
  [[nodiscard]] bool IsWhole() const { return reset == 0 && shape < 0.25; }
};

// Two seconds of a body on the ground, and the places of its vertices in each tick of the last half second, m. start:
// one position a vertex, relative to the body's place.
inline std::vector<std::vector<Vector3d>> PlayOnGround(const Blueprint& blueprint, std::vector<Vector3d> start,
                                                       Recovery& recovery) {
  World world(WorldSettings{});
  world.AddObstacle({});
  const Vector3d place(0, 0, 1.2 * blueprint.reach);
  const BodyId id = world.AddBody(world.AddBlueprint(blueprint), place);
  for (Vector3d& p : start) p += place;
  world.SetMotion(id, start, std::vector<Vector3d>(start.size(), Vector3d::Zero()));
  Vector3d before = world.FindCentre(world.ReadBody(id));
  std::vector<std::vector<Vector3d>> shapes;
  for (int tick = 0; tick < 120; ++tick) {
    recovery.reset += world.Step().reset;
    const Vector3d centre = world.FindCentre(world.ReadBody(id));
    recovery.speed = std::max(recovery.speed, 60 * (centre - before).norm());
    before = centre;
    if (tick < 90) continue;
    shapes.emplace_back();
    VisitVertices(world.ReadBody(id), [&](std::size_t, const Vector3d& p) { shapes.back().push_back(p); });
  }
  return shapes;
}

// Two seconds of a body of this blueprint on the ground. start: as in PlayOnGround.
inline Recovery PlayRecovery(const Blueprint& blueprint, const std::vector<Vector3d>& start) {
  Recovery ofWhole;
  Recovery recovery;
  const auto whole = PlayOnGround(blueprint, blueprint.rest, ofWhole);
  const auto broken = PlayOnGround(blueprint, start, recovery);
  recovery.shape = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i < broken.size(); ++i) {
    recovery.shape = std::min(recovery.shape, FindShapeDistance(broken[i], whole[i]) / blueprint.size);
  }
  return recovery;
}

inline Recovery PlayBroken(Broken how, const Blueprint& blueprint, bench::Random& random) {
  return PlayRecovery(blueprint, Break(how, blueprint, random));
}

}  // namespace wobble::physics
