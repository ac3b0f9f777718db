// The vertices of a body's surface at one moment, as the search for contacts reads them.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "server/physics/contact/face_search.h"
#include "server/physics/lanes/point_lanes.h"

namespace wobble::physics {

template <class Real>
class SkinPoints {
 public:
  // Room for so many vertices.
  void Reserve(std::size_t vertices);
  // At least one face. v: of all vertices, m/s.
  void Read(const Skin<Real>& skin, std::span<const Vector3<Real>> v);

  // Those of topology.vertices, in their order.
  [[nodiscard]] PointLanes<Real> Lanes() const;
  // Of a ball that holds all of the surface, m.
  [[nodiscard]] const Vector3<Real>& Centre() const { return m_centre; }
  [[nodiscard]] Real Radius() const { return m_radius; }
  // About which all of the surface moves, m/s, and no faster than this against it.
  [[nodiscard]] const Vector3<Real>& Velocity() const { return m_velocity; }
  [[nodiscard]] Real Agitation() const { return m_agitation; }
  // Square of how far a point of the surface may be from the nearest vertex, m².
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
