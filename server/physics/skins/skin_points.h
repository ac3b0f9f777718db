// The vertices of a body's skin at one moment, laid out for the search for contacts: coordinates in vectors, and bounds
// of positions and velocities.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "server/physics/kernels/contact/point_lanes.h"
#include "server/physics/skins/face_search.h"

namespace wobble::physics {

template <class Real>
class SkinPoints {
 public:
  // Makes room for this number of vertices, so that Read allocates nothing.
  void Reserve(std::size_t vertices);
  // skin: at least one face. v: of all the body's vertices, m/s.
  void Read(const Skin<Real>& skin, std::span<const Vector3<Real>> v);

  // The points of topology.vertices, in their order; valid until the next Read.
  [[nodiscard]] PointLanes<Real> Lanes() const;
  // Centre and radius of a ball that holds the whole skin, local coordinates, m.
  [[nodiscard]] const Vector3<Real>& Centre() const { return m_centre; }
  [[nodiscard]] Real Radius() const { return m_radius; }
  // A velocity, m/s, and the largest speed of a skin vertex against it, m/s.
  [[nodiscard]] const Vector3<Real>& Velocity() const { return m_velocity; }
  [[nodiscard]] Real Agitation() const { return m_agitation; }
  // Bound of the squared distance from a point of the skin to its nearest vertex, m².
  [[nodiscard]] Real SquaredGap() const { return m_squaredGap; }

 private:
  struct alignas(64) Line {
    std::array<Real, kPointsInBlock> numbers;
  };

  std::size_t m_blocks = 0;
  std::vector<Line> m_lines;  // [axis][block]
  Vector3<Real> m_centre = Vector3<Real>::Zero();
  Real m_radius = 0;
  Vector3<Real> m_velocity = Vector3<Real>::Zero();
  Real m_agitation = 0;
  Real m_squaredGap = 0;
};

}  // namespace wobble::physics
