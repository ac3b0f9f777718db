// Input and output of the kernel that searches among the points of a skin.
#pragma once

#include <cstddef>
#include <cstdint>

namespace wobble::physics {

inline constexpr std::size_t kPointsInBlock = 16;
// Coordinate of the points that pad the last block, m: near nothing, and its square is still finite.
inline constexpr float kNoPlace = 1e18F;

template <class Real>
struct PointLanes {
  std::size_t count = 0;  // a multiple of kPointsInBlock
  const Real* x[3] = {};  // an array for each axis, m
};

// The intersection of a box and a ball, m.
template <class Real>
struct NearRegion {
  Real low[3] = {};
  Real high[3] = {};
  Real centre[3] = {};
  Real squaredRadius = 0;
};

template <class Real>
struct NearestPoint {
  std::uint32_t index = 0;
  Real square = 0;  // of the distance, m²
};

template <class Real>
struct PointKernel {
  // Fills `found`, which has room for all points, with the indices of those in the region, ascending. Returns how many.
  std::size_t (*findWithin)(const PointLanes<Real>& points, const NearRegion<Real>& region,
                            std::uint16_t* found) = nullptr;
  // The point nearest to p; of equally near ones the first. There must be at least one point.
  NearestPoint<Real> (*findNearest)(const PointLanes<Real>& points, const Real* p) = nullptr;
};

}  // namespace wobble::physics
