// Read once a tick for each skin that comes near another. The search then asks bounds and whole blocks of points, and
// only few vertices one by one.
#include "server/physics/skins/skin_points.h"

#include <algorithm>
#include <cmath>

namespace wobble::physics {
namespace {

constexpr std::size_t CountBlocks(std::size_t vertices) { return (vertices + kPointsInBlock - 1) / kPointsInBlock; }

// No point of a triangle is farther from its nearest corner than the longest side over √3, the distance in the middle
// of an equilateral triangle.
template <class Real>
Real FindSquaredGap(const Skin<Real>& skin) {
  Real longest = 0;
  for (const auto& side : skin.topology->sides) {
    longest = std::max(longest, (skin.x[side[0]] - skin.x[side[1]]).squaredNorm());
  }
  return longest / Real(3);
}

template <class Real>
struct Ball {
  Vector3<Real> centre;
  Real radius = 0;
};
// A ball that holds the values of these vertices, about the middle of their box.
template <class Real>
Ball<Real> FindBall(const VectorView<Real>& values, std::span<const std::uint16_t> vertices) {
  Vector3<Real> low = values[vertices[0]];
  Vector3<Real> high = low;
  for (const std::uint16_t vertex : vertices) {
    low = low.cwiseMin(values[vertex]);
    high = high.cwiseMax(values[vertex]);
  }
  const Vector3<Real> centre = (low + high) / Real(2);
  Real square = 0;
  for (const std::uint16_t vertex : vertices) square = std::max(square, (values[vertex] - centre).squaredNorm());
  return {centre, std::sqrt(square)};
}

}  // namespace

template <class Real>
void SkinPoints<Real>::Reserve(std::size_t vertices) {
  m_lines.reserve(3 * CountBlocks(vertices));
}

template <class Real>
void SkinPoints<Real>::Read(const Skin<Real>& skin, std::span<const Vector3<Real>> v) {
  const std::span<const std::uint16_t> vertices(skin.topology->vertices);
  m_blocks = CountBlocks(vertices.size());
  m_lines.resize(3 * m_blocks);
  for (std::size_t i = 0; i < m_blocks * kPointsInBlock; ++i) {
    const Vector3<Real> x = i < vertices.size() ? skin.x[vertices[i]] : Vector3<Real>::Constant(Real(kNoPlace));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      m_lines[axis * m_blocks + i / kPointsInBlock].numbers[i % kPointsInBlock] = x[static_cast<int>(axis)];
    }
  }
  const Ball<Real> ofPlaces = FindBall<Real>(skin.x, vertices);
  const Ball<Real> ofVelocities = FindBall<Real>(v, vertices);
  m_centre = ofPlaces.centre;
  m_radius = ofPlaces.radius;
  m_velocity = ofVelocities.centre;
  m_agitation = ofVelocities.radius;
  m_squaredGap = FindSquaredGap(skin);
}

template <class Real>
PointLanes<Real> SkinPoints<Real>::Lanes() const {
  PointLanes<Real> lanes;
  lanes.count = m_blocks * kPointsInBlock;
  for (std::size_t axis = 0; axis < 3; ++axis) lanes.x[axis] = m_lines[axis * m_blocks].numbers.data();
  return lanes;
}

template class SkinPoints<float>;
template class SkinPoints<double>;

}  // namespace wobble::physics
