#include "tests/bench/codec/grid.h"

#include <algorithm>
#include <cmath>

namespace wobble::bench {
namespace {

using protocol::Vector3;

std::int16_t Round(float way, double step) {
  return static_cast<std::int16_t>(std::clamp(std::nearbyint(static_cast<double>(way) / step), -32767.0, 32767.0));
}

float RoundCentroid(float place) { return std::nearbyint(place / kCentroidStep) * kCentroidStep; }
Vector3 RoundCentroid(Vector3 v) { return {RoundCentroid(v.x), RoundCentroid(v.y), RoundCentroid(v.z)}; }

}  // namespace

GridBody PutOnGrid(const server::CapturedBody& body, double step, bool isCentred) {
  GridBody grid;
  if (isCentred) grid.centre = RoundCentroid(body.pose.centroid);
  for (const Vector3& vertex : body.vertices) {
    const Vector3 way = vertex - grid.centre;
    for (const float each : {way.x, way.y, way.z}) grid.places.push_back(Round(each, step));
  }
  return grid;
}

void TakeOffGrid(const GridBody& body, double step, std::vector<Vector3>& vertices) {
  const auto size = static_cast<float>(step);
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    vertices[i] = body.centre + Vector3{static_cast<float>(body.places[3 * i]) * size,
                                        static_cast<float>(body.places[3 * i + 1]) * size,
                                        static_cast<float>(body.places[3 * i + 2]) * size};
  }
}

std::vector<std::uint8_t> SplitPlanes(const std::vector<std::int16_t>& numbers) {
  std::vector<std::uint8_t> planes(2 * numbers.size());
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    // Puts the sign into the lowest bit; otherwise high bytes would alternate between 0 and 255.
    const auto folded = static_cast<std::uint16_t>((numbers[i] * 2) ^ (numbers[i] >> 15));
    planes[i] = static_cast<std::uint8_t>(folded);
    planes[numbers.size() + i] = static_cast<std::uint8_t>(folded >> 8);
  }
  return planes;
}

std::vector<std::int16_t> JoinPlanes(const std::vector<std::uint8_t>& planes) {
  std::vector<std::int16_t> numbers(planes.size() / 2);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const auto folded = static_cast<std::uint16_t>(planes[i] | planes[numbers.size() + i] << 8);
    numbers[i] = static_cast<std::int16_t>((folded >> 1) ^ -(folded & 1));
  }
  return numbers;
}

}  // namespace wobble::bench
