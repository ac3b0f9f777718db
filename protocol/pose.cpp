#include "protocol/pose.h"

#include <algorithm>
#include <array>

#include "protocol/limits.h"

namespace wobble::protocol {
namespace {

constexpr unsigned kCentroidBits = 26;
constexpr std::int32_t kCentroidLimit = (1 << (kCentroidBits - 1)) - 1;
constexpr unsigned kRotationBits = 15;
// Component c in [-1/√2, 1/√2] ↔ integer in [0, 2·16383]; zero is exact, so an unturned body is exactly unturned.
constexpr std::int32_t kRotationHalf = (1 << (kRotationBits - 1)) - 1;
constexpr float kRotationScale = 0.70710678F / static_cast<float>(kRotationHalf);

std::int32_t QuantiseCoordinate(float value) {
  const double grid = std::nearbyint(static_cast<double>(value) / kCentroidStep);
  return static_cast<std::int32_t>(std::clamp(grid, -double{kCentroidLimit}, double{kCentroidLimit}));
}

float Component(std::uint32_t value) {
  return static_cast<float>(static_cast<std::int32_t>(value) - kRotationHalf) * kRotationScale;
}

// 1 − a² − b² − c², the square of the component left out.
float SquareLeft(const QuantisedPose& pose) {
  const float a = Component(pose.a), b = Component(pose.b), c = Component(pose.c);
  return 1.0F - a * a - b * b - c * c;
}

}  // namespace

QuantisedPose Quantise(const Pose& pose) {
  QuantisedPose result;
  result.x = QuantiseCoordinate(pose.centroid.x);
  result.y = QuantiseCoordinate(pose.centroid.y);
  result.z = QuantiseCoordinate(pose.centroid.z);

  std::array<float, 4> q{pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z};
  const float length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(length > 0.0F)) q = {1.0F, 0.0F, 0.0F, 0.0F};
  for (std::uint32_t i = 1; i < 4; ++i) {
    if (std::fabs(q[i]) > std::fabs(q[result.largest])) result.largest = i;
  }
  const float sign = q[result.largest] < 0.0F ? -1.0F : 1.0F;
  const float scale = length > 0.0F ? sign / (length * kRotationScale) : sign / kRotationScale;
  std::array<std::uint32_t*, 3> fields{&result.a, &result.b, &result.c};
  std::size_t next = 0;
  for (std::uint32_t i = 0; i < 4; ++i) {
    if (i == result.largest) continue;
    const float grid =
        std::clamp(std::nearbyint(q[i] * scale), -static_cast<float>(kRotationHalf), static_cast<float>(kRotationHalf));
    *fields[next++] = static_cast<std::uint32_t>(static_cast<std::int32_t>(grid) + kRotationHalf);
  }
  return result;
}

Pose Dequantise(const QuantisedPose& pose) {
  Pose result;
  constexpr auto kStep = static_cast<float>(kCentroidStep);
  result.centroid = {static_cast<float>(pose.x) * kStep, static_cast<float>(pose.y) * kStep,
                     static_cast<float>(pose.z) * kStep};
  const float left = std::sqrt(std::max(SquareLeft(pose), 0.0F));
  std::array<float, 4> q{};
  const std::array<float, 3> others{Component(pose.a), Component(pose.b), Component(pose.c)};
  std::size_t next = 0;
  for (std::uint32_t i = 0; i < 4; ++i) q[i] = i == pose.largest ? left : others[next++];
  result.rotation = {q[0], q[1], q[2], q[3]};
  return result;
}

void WritePose(BitWriter& writer, const QuantisedPose& pose) {
  for (const std::int32_t value : {pose.x, pose.y, pose.z}) {
    writer.Write(static_cast<std::uint32_t>(value) & ((1U << kCentroidBits) - 1), kCentroidBits);
  }
  writer.Write(pose.largest, 2);
  for (const std::uint32_t value : {pose.a, pose.b, pose.c}) writer.Write(value, kRotationBits);
}

bool ReadPose(BitReader& reader, QuantisedPose& pose) {
  for (std::int32_t* value : {&pose.x, &pose.y, &pose.z}) {
    const auto raw = static_cast<std::int32_t>(reader.Read(kCentroidBits) << (32 - kCentroidBits));
    *value = raw >> (32 - kCentroidBits);  // extends the sign
  }
  pose.largest = reader.Read(2);
  for (std::uint32_t* value : {&pose.a, &pose.b, &pose.c}) {
    *value = reader.Read(kRotationBits);
    if (*value > 2U * kRotationHalf) return false;
  }
  // The component left out is the largest, so its square is a quarter at least; anything else is no rotation.
  return !reader.Overran() && SquareLeft(pose) > 0.2F;
}

}  // namespace wobble::protocol
