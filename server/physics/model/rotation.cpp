#include "server/physics/model/rotation.h"

#include <cmath>
#include <utility>

namespace wobble::physics {
namespace {

// Turns axes a and b of the symmetric matrix `s` so that s[a][b] becomes 0 (Jacobi 1846), and the columns of `turns`
// with them.
void Diagonalise(std::size_t a, std::size_t b, std::array<std::array<double, 3>, 3>& s, Columns& turns) {
  if (s[a][b] == 0) return;
  const double theta = (s[b][b] - s[a][a]) / (2 * s[a][b]);
  const double t = (theta >= 0 ? 1 : -1) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
  const double c = 1 / std::sqrt(t * t + 1);
  const double d = t * c;
  const std::size_t other = 3 - a - b;
  s[a][a] -= t * s[a][b];
  s[b][b] += t * s[a][b];
  s[a][b] = s[b][a] = 0;
  const double ofA = c * s[a][other] - d * s[b][other];
  const double ofB = d * s[a][other] + c * s[b][other];
  s[a][other] = s[other][a] = ofA;
  s[b][other] = s[other][b] = ofB;
  const Vector3d first = c * turns[a] - d * turns[b];
  turns[b] = d * turns[a] + c * turns[b];
  turns[a] = first;
}

Vector3d FindUnit(const Vector3d& along, const Vector3d& otherwise) {
  const double length = std::sqrt(along.dot(along));
  return length > 1e-9 ? Vector3d(along / length) : otherwise;
}

}  // namespace

// The search turns a quaternion until Σ r_col × a_col vanishes (Müller, Bender, Chentanez & Macklin 2016).
//
// A singular value decomposition was rejected: it jumps when a flattened body makes A degenerate, and whoever
// interpolates would show the jump as a flip.
Eigen::Quaterniond FindRotation(const Eigen::Matrix3d& a, const Eigen::Quaterniond& near) {
  Eigen::Quaterniond q = near;
  for (int round = 0; round < 20; ++round) {
    const Eigen::Matrix3d r = q.toRotationMatrix();
    const Vector3d turn = r.col(0).cross(a.col(0)) + r.col(1).cross(a.col(1)) + r.col(2).cross(a.col(2));
    const double along = r.col(0).dot(a.col(0)) + r.col(1).dot(a.col(1)) + r.col(2).dot(a.col(2));
    const Vector3d omega = turn / (std::fabs(along) + 1e-9);
    const double angle = omega.norm();
    if (angle < 1e-6) break;
    q = Eigen::Quaterniond(Eigen::AngleAxisd(angle, omega / angle)) * q;
    q.normalize();
  }
  return q;
}

// By the eigenvectors of FᵀF. u₃ and v₃ follow from the others, so that both systems are right-handed and σ₃ has J's
// sign.
Stretches FindStretches(const Columns& f) {
  std::array<std::array<double, 3>, 3> s;
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) s[i][j] = f[i].dot(f[j]);
  }
  Columns turns{Vector3d::UnitX(), Vector3d::UnitY(), Vector3d::UnitZ()};
  constexpr int kSweeps = 6;
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    Diagonalise(0, 1, s, turns);
    Diagonalise(0, 2, s, turns);
    Diagonalise(1, 2, s, turns);
  }
  std::array<std::size_t, 3> order{0, 1, 2};
  const auto sort = [&](std::size_t i, std::size_t j) {
    if (s[order[i]][order[i]] < s[order[j]][order[j]]) std::swap(order[i], order[j]);
  };
  sort(0, 1);
  sort(1, 2);
  sort(0, 1);
  const auto apply = [&f](const Vector3d& v) { return Vector3d(v[0] * f[0] + v[1] * f[1] + v[2] * f[2]); };
  Stretches stretches;
  auto& [values, left, right] = stretches;
  right = {turns[order[0]], turns[order[1]], turns[order[0]].cross(turns[order[1]])};
  left[0] = FindUnit(apply(right[0]), Vector3d::UnitX());
  const Vector3d second = apply(right[1]);
  const Vector3d across = std::fabs(left[0].x()) < 0.7 ? Vector3d::UnitX() : Vector3d::UnitY();
  left[1] = FindUnit(second - left[0].dot(second) * left[0], left[0].cross(across).normalized());
  left[2] = left[0].cross(left[1]);
  for (std::size_t i = 0; i < 3; ++i) values[i] = left[i].dot(apply(right[i]));
  return stretches;
}

void RemoveRigidMotion(std::span<const double> masses, std::span<const Vector3d> x, std::span<Vector3d> v) {
  const auto massOf = [&](std::size_t i) { return masses.empty() ? 1 : masses[i]; };
  double mass = 0;
  for (std::size_t i = 0; i < x.size(); ++i) mass += massOf(i);
  Vector3d centre = Vector3d::Zero();
  Vector3d mean = Vector3d::Zero();
  for (std::size_t i = 0; i < x.size(); ++i) {
    centre += massOf(i) / mass * x[i];
    mean += massOf(i) / mass * v[i];
  }
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();
  Vector3d momentum = Vector3d::Zero();
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vector3d r = x[i] - centre;
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) inertia(a, b) += massOf(i) * ((a == b ? r.dot(r) : 0) - r[a] * r[b]);
    }
    momentum += massOf(i) * r.cross(v[i]);
  }
  // Points on a line have no momentum about it, and any turning about it will do.
  const double slack = 1e-12 * (inertia(0, 0) + inertia(1, 1) + inertia(2, 2));
  const Vector3d a(inertia(0, 0) + slack, inertia(1, 0), inertia(2, 0));
  const Vector3d b(inertia(0, 1), inertia(1, 1) + slack, inertia(2, 1));
  const Vector3d c(inertia(0, 2), inertia(1, 2), inertia(2, 2) + slack);
  const double determinant = a.dot(b.cross(c));
  Vector3d turning = Vector3d::Zero();
  if (determinant > 0) {
    turning = Vector3d(momentum.dot(b.cross(c)), momentum.dot(c.cross(a)), momentum.dot(a.cross(b))) / determinant;
  }
  for (std::size_t i = 0; i < x.size(); ++i) v[i] -= mean + turning.cross(x[i] - centre);
}

}  // namespace wobble::physics
