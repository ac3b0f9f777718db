// Poses on a grid as coarse as the shape's error allows: 80 bits for a ball in an arena, where a fixed grid took 125.
//
// The shape is coded against the pose as decoded, so a coarse pose costs no accuracy but makes the shape dearer: steps
// of a quarter of the error target were cheapest (half of it: +0.07 bits a vertex, no finer than the target: +0.2).
// Each coordinate of the centroid is an exponential Golomb code whose exponent is entropy-coded. That costs as much as
// a code bounded by the room's size would, so no bounds need to be agreed. The rotation is sent as the three smallest
// components of its quaternion; since a quaternion and its negative are the same rotation, these determine it.
#pragma once

#include <cmath>
#include <cstdint>

#include "protocol/codec/range_coder.h"
#include "protocol/geometry.h"

namespace wobble::protocol {

// Centroids are multiples of 2^-grid m, components of rotations multiples of 2^-turn.
struct PoseGrid {
  unsigned grid = 0;
  unsigned turn = 0;
};
inline constexpr unsigned kFinestGrid = 17;
inline constexpr unsigned kCoarsestTurn = 7;
inline constexpr unsigned kFinestTurn = 16;

// A pose on a grid, in steps. The same on both ends to the bit.
struct QuantisedPose {
  PoseGrid grid;
  std::int32_t x = 0, y = 0, z = 0;  // centroid
  std::uint32_t largest = 0;         // index in w x y z of the component that is left out
  std::int32_t a = 0, b = 0, c = 0;  // the other components in order
};

// The smallest n with size < 2^n. size: above 0.
[[nodiscard]] inline int FindExponent(float size) {
  int exponent = 0;
  static_cast<void>(std::frexp(size, &exponent));
  return exponent;
}

// The grid for a body of this size (RMS distance of its rest vertices from their centroid, m; above 0): a step of
// rotation moves vertices no further than a step of the centroid does. grid <= kFinestGrid.
[[nodiscard]] PoseGrid MakePoseGrid(unsigned grid, float size);

// The nearest pose on the grid. A centroid beyond kWorldHalfExtent is put on the border; a rotation that is not of unit
// length is normalised.
[[nodiscard]] QuantisedPose Quantise(const Pose& pose, PoseGrid grid);
// The pose in metres, with a rotation of unit length.
[[nodiscard]] Pose Dequantise(const QuantisedPose& pose);

void WritePose(RangeEncoder& encoder, const QuantisedPose& pose);
// Reads all fields but pose.grid, which must be set. False when they are outside the world or describe no rotation.
[[nodiscard]] bool ReadPose(RangeDecoder& decoder, QuantisedPose& pose);

}  // namespace wobble::protocol
