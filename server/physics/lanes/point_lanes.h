// Points of a surface, side by side, and what is asked of all of them at once.
#pragma once

#include <cstddef>
#include <cstdint>

namespace wobble::physics {

inline constexpr std::size_t kPointsInBlock = 16;
// Where the points are that fill the last block, on every axis, m: nowhere near, and their squares still numbers.
inline constexpr float kNoPlace = 1e18F;

template <class Real>
struct PointLanes {
  std::size_t count = 0;  // in whole blocks
  const Real* x[3] = {};  // m
};

// A box and a ball: what is in both.
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
  // Fills `found` with the indices of the points in the region, ascending; it has room for all. Returns how many.
  std::size_t (*findWithin)(const PointLanes<Real>& points, const NearRegion<Real>& region,
                            std::uint16_t* found) = nullptr;
  // Of those equally near the first. At least one point.
  NearestPoint<Real> (*findNearest)(const PointLanes<Real>& points, const Real* p) = nullptr;
};

}  // namespace wobble::physics
