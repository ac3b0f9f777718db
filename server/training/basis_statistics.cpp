// Departures and their predictions are averaged over the symmetries of the rest shape. The candidates for a symmetry
// are the maps that carry one pair of vertices to a pair at the same distances; each is kept if it maps every vertex
// onto one.
#include "server/training/basis_statistics.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <optional>

#include "protocol/codec/flat_sides.h"
#include "protocol/codec/patch_model.h"

namespace wobble::server {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using protocol::Vector3;

// How far the image of a vertex may be from a vertex, as a share of the rest shape's size.
constexpr double kTolerance = 2e-3;

std::vector<Vector3d> ToDouble(std::span<const Vector3> points) {
  std::vector<Vector3d> result;
  for (const Vector3& p : points) result.emplace_back(p.x, p.y, p.z);
  return result;
}

std::optional<Symmetry> FindImage(const std::vector<Vector3d>& rest, const Matrix3d& matrix, double tolerance) {
  Symmetry symmetry{matrix, {}};
  for (const Vector3d& point : rest) {
    const Vector3d moved = matrix * point;
    std::size_t image = 0;
    while (image < rest.size() && (rest[image] - moved).squaredNorm() > tolerance * tolerance) ++image;
    if (image == rest.size()) return std::nullopt;
    symmetry.image.push_back(image);
  }
  return symmetry;
}

// Finds two vertices that span a plane with the centre. They are near each other, so that few pairs are as far apart.
std::pair<std::size_t, std::size_t> FindPair(const std::vector<Vector3d>& rest, double size) {
  std::size_t a = 0;
  for (std::size_t i = 1; i < rest.size(); ++i) {
    if (rest[i].squaredNorm() > rest[a].squaredNorm()) a = i;
  }
  std::size_t b = a;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    if (rest[i].cross(rest[a]).norm() < 0.1 * size * rest[a].norm()) continue;
    if (b == a || (rest[i] - rest[a]).norm() < (rest[b] - rest[a]).norm()) b = i;
  }
  return {a, b};
}

Matrix3d MakeFrame(const Vector3d& a, const Vector3d& b, double side) {
  Matrix3d frame;
  frame << a, b, side * a.cross(b);
  return frame;
}

// Adds to `sum` the moments of the body's image under the symmetry.
void AddImage(const MatrixXd& moments, const Symmetry& symmetry, MatrixXd& sum) {
  MatrixXd turned(3, moments.cols());
  for (std::size_t i = 0; i < symmetry.image.size(); ++i) {
    const auto from = static_cast<Eigen::Index>(3 * i), to = static_cast<Eigen::Index>(3 * symmetry.image[i]);
    turned.noalias() = symmetry.matrix * moments.middleRows(from, 3);
    for (std::size_t j = 0; j < symmetry.image.size(); ++j) {
      sum.block<3, 3>(to, static_cast<Eigen::Index>(3 * symmetry.image[j])) +=
          turned.middleCols<3>(static_cast<Eigen::Index>(3 * j)).lazyProduct(symmetry.matrix.transpose());
    }
  }
}

// Averages the moments over all symmetries. With more than kFew symmetries, it replaces the moments kFew times by their
// mean with their image under one of them, which halves the asymmetric part each time.
MatrixXd Average(MatrixXd moments, const std::vector<Symmetry>& symmetries) {
  constexpr std::size_t kFew = 20;
  if (symmetries.size() == 1) return moments;
  if (symmetries.size() > kFew) {
    for (std::size_t i = 0; i < kFew; ++i) {
      MatrixXd sum = moments;
      AddImage(moments, symmetries[(37 * i + 11) % symmetries.size()], sum);
      moments = 0.5 * sum;
    }
    return moments;
  }
  MatrixXd sum = MatrixXd::Zero(moments.rows(), moments.cols());
  for (const Symmetry& symmetry : symmetries) AddImage(moments, symmetry, sum);
  return sum / static_cast<double>(symmetries.size());
}

}  // namespace

std::vector<Symmetry> FindSymmetries(std::span<const Vector3> rest) {
  const std::vector<Vector3d> points = ToDouble(rest);
  std::vector<Symmetry> symmetries;
  double size = 0;
  for (const Vector3d& point : points) size = std::max(size, point.norm());
  const double tolerance = kTolerance * size;
  const auto [a, b] = FindPair(points, size);
  if (a != b) {
    const Matrix3d inverse = MakeFrame(points[a], points[b], 1).inverse();
    const double apart = (points[a] - points[b]).norm();
    const auto isLike = [&](double x, double y) { return std::fabs(x - y) < 2 * tolerance; };
    for (const Vector3d& i : points) {
      if (!isLike(i.norm(), points[a].norm())) continue;
      for (const Vector3d& j : points) {
        if (!isLike(j.norm(), points[b].norm()) || !isLike((i - j).norm(), apart)) continue;
        for (const double side : {1.0, -1.0}) {
          auto found = FindImage(points, MakeFrame(i, j, side) * inverse, tolerance);
          if (found) symmetries.push_back(std::move(*found));
        }
      }
    }
  }
  if (symmetries.empty()) symmetries.push_back(*FindImage(points, Matrix3d::Identity(), tolerance));
  return symmetries;
}

BasisStatistics MeasurePlay(const RecordedPlay& play, std::span<const Vector3> rest, std::size_t first) {
  const auto rows = static_cast<Eigen::Index>(3 * rest.size());
  const auto count = static_cast<Eigen::Index>(play.frames.size());
  MatrixXd departures(rows, count), contacts(rows, count);
  const float reach = protocol::FindReach(rest);
  std::vector<protocol::Side> sides;
  std::vector<Vector3> pressed;
  for (Eigen::Index f = 0; f < count; ++f) {
    const PlayFrame& frame = play.frames[static_cast<std::size_t>(f)];
    protocol::FindSides(play.obstacles, frame.pose, reach, sides);
    pressed.assign(rest.begin(), rest.end());
    static_cast<void>(protocol::PressOut(sides, pressed));
    const protocol::Quaternion inverse = protocol::Conjugate(frame.pose.rotation);
    for (std::size_t i = 0; i < rest.size(); ++i) {
      const Vector3 way = protocol::Rotate(inverse, frame.vertices[first + i] - frame.pose.centroid) - rest[i];
      const Vector3 pushed = pressed[i] - rest[i];
      const auto row = static_cast<Eigen::Index>(3 * i);
      departures.col(f).segment<3>(row) << double{way.x}, double{way.y}, double{way.z};
      contacts.col(f).segment<3>(row) << double{pushed.x}, double{pushed.y}, double{pushed.z};
    }
  }
  const std::vector<Symmetry> symmetries = FindSymmetries(rest);
  const double share = 1.0 / static_cast<double>(count);
  BasisStatistics statistics;
  statistics.departure = Average(share * departures * departures.transpose(), symmetries);
  statistics.departureByContact = Average(share * departures * contacts.transpose(), symmetries);
  statistics.contact = Average(share * contacts * contacts.transpose(), symmetries);
  return statistics;
}

}  // namespace wobble::server
