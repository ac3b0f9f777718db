// Quantises vertices to a grid about the body's centroid or the world's origin, for methods that code integers.
#pragma once

#include <cstdint>
#include <vector>

#include "protocol/geometry.h"
#include "server/snapshots/capture.h"

namespace wobble::bench {

struct GridBody {
  protocol::Vector3 centre;          // the world's origin, or the centroid rounded to kCentroidStep
  std::vector<std::int16_t> places;  // x, y, z of each vertex, in grid steps
};
inline constexpr float kCentroidStep = 1.0F / 4096;  // m
// Size of a coded centroid: three numbers of 26 bits.
inline constexpr std::size_t kCentroidBytes = 10;

// isCentred: relative to the centroid, so that for a body in rigid flight only the centroid changes.
[[nodiscard]] GridBody PutOnGrid(const server::CapturedBody& body, double step, bool isCentred);
void TakeOffGrid(const GridBody& body, double step, std::vector<protocol::Vector3>& vertices);

// SplitPlanes puts all low bytes before all high bytes, because the high bytes of small numbers are alike; JoinPlanes
// undoes it.
[[nodiscard]] std::vector<std::uint8_t> SplitPlanes(const std::vector<std::int16_t>& numbers);
[[nodiscard]] std::vector<std::int16_t> JoinPlanes(const std::vector<std::uint8_t>& planes);

}  // namespace wobble::bench
