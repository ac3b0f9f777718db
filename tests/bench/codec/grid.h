// Vertices on a grid, about the body's centroid or the world's origin: what coders of integers are given.
#pragma once

#include <cstdint>
#include <vector>

#include "protocol/geometry.h"
#include "server/snapshots/capture.h"

namespace wobble::bench {

struct GridBody {
  protocol::Vector3 centre;          // the world's origin, or the centroid in steps of kCentroidStep
  std::vector<std::int16_t> places;  // x, y, z of each vertex, in steps
};
inline constexpr float kCentroidStep = 1.0F / 4096;  // m
// Of a centroid: three numbers of 26 bits.
inline constexpr std::size_t kCentroidBytes = 10;

// isCentred: about the centroid, so that a body that only flies has nothing new to say but where it is.
[[nodiscard]] GridBody PutOnGrid(const server::CapturedBody& body, double step, bool isCentred);
void TakeOffGrid(const GridBody& body, double step, std::vector<protocol::Vector3>& vertices);

// Every odd byte after every even one: the high bytes of small numbers are all alike.
[[nodiscard]] std::vector<std::uint8_t> SplitPlanes(const std::vector<std::int16_t>& numbers);
[[nodiscard]] std::vector<std::int16_t> JoinPlanes(const std::vector<std::uint8_t>& planes);

}  // namespace wobble::bench
