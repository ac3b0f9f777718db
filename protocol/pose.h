// A pose in 125 bits: the centroid on a grid of kCentroidStep (3 x 26 bits), the rotation as the three smallest
// components of its quaternion (2 + 3 x 15 bits).
//
// The largest component follows from the unit length, and a quaternion and its negative are one rotation, so three
// components in [-1/sqrt 2, 1/sqrt 2] say all. The shape is coded against the pose as the decoder will see it, so the
// rounding here costs no accuracy.
#pragma once

#include "protocol/bits.h"
#include "protocol/geometry.h"

namespace wobble::protocol {

// A pose on the wire's grid.
struct QuantisedPose {
  std::int32_t x = 0, y = 0, z = 0;   // centroid / kCentroidStep, signed 26-bit
  std::uint32_t largest = 0;          // index of the component left out: w x y z
  std::uint32_t a = 0, b = 0, c = 0;  // the others in order, 15 bits
};

// The nearest pose on the grid; a centroid beyond kWorldHalfExtent is put on the border, a rotation that is not of unit
// length is normalised.
[[nodiscard]] QuantisedPose Quantise(const Pose& pose);
[[nodiscard]] Pose Dequantise(const QuantisedPose& pose);

void WritePose(BitWriter& writer, const QuantisedPose& pose);
// False when the fields name no rotation.
[[nodiscard]] bool ReadPose(BitReader& reader, QuantisedPose& pose);

}  // namespace wobble::protocol
