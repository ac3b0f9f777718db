#include "protocol/codec/pose.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>

#include "protocol/limits.h"

namespace wobble::protocol {
namespace {

// Bits of a coordinate: 8,192 m in steps of 2^-17 m.
constexpr unsigned kMaxLength = 31;
// Frequencies of the bit length of a centroid's coordinate, from 0, out of kFrequencyTotal. Broad about 2^13 steps,
// which is a few metres at the usual target.
constexpr std::array<std::uint16_t, kMaxLength + 1> kLengthFrequencies = {
    40,  20,  20, 20, 24, 32, 44, 60, 90, 140, 220, 350, 520, 680, 640, 480,
    300, 170, 90, 50, 30, 20, 14, 10, 8,  6,   4,   4,   4,   2,   2,   2};

constexpr std::array<std::uint16_t, kMaxLength + 2> MakeStarts() {
  std::array<std::uint16_t, kMaxLength + 2> starts{};
  for (std::size_t i = 0; i <= kMaxLength; ++i) {
    starts[i + 1] = static_cast<std::uint16_t>(starts[i] + kLengthFrequencies[i]);
  }
  return starts;
}
constexpr auto kLengthStarts = MakeStarts();
static_assert(kLengthStarts.back() == kFrequencyTotal);

// Writes a number below 2^bits in pieces of at most 16 bits, which the range coder takes.
void WriteBits(RangeEncoder& encoder, std::uint32_t value, unsigned bits) {
  for (; bits > 16; bits -= 16, value >>= 16) encoder.EncodeBits(value & 0xFFFF, 16);
  encoder.EncodeBits(value, bits);
}

std::uint32_t ReadBits(RangeDecoder& decoder, unsigned bits) {
  std::uint32_t value = 0;
  unsigned shift = 0;
  for (; bits > 16; bits -= 16, shift += 16) value |= decoder.DecodeBits(16) << shift;
  return value | decoder.DecodeBits(bits) << shift;
}

void WriteCoordinate(RangeEncoder& encoder, std::int32_t value) {
  const auto size = static_cast<std::uint32_t>(value < 0 ? -value : value);
  const auto length = static_cast<unsigned>(std::bit_width(size));
  encoder.Encode(kLengthStarts[length], kLengthFrequencies[length]);
  if (length == 0) return;
  WriteBits(encoder, size ^ 1U << (length - 1), length - 1);
  encoder.EncodeBits(value < 0 ? 1 : 0, 1);
}

std::int32_t ReadCoordinate(RangeDecoder& decoder) {
  const std::uint32_t place = decoder.Find();
  unsigned length = 0;
  while (kLengthStarts[length + 1] <= place) ++length;
  decoder.Take(kLengthStarts[length], kLengthFrequencies[length]);
  if (length == 0) return 0;
  const auto size = static_cast<std::int32_t>(ReadBits(decoder, length - 1) | 1U << (length - 1));
  return decoder.DecodeBits(1) != 0 ? -size : size;
}

std::int32_t QuantiseCoordinate(float value, unsigned grid) {
  const double limit = std::ldexp(kWorldHalfExtent, static_cast<int>(grid));
  const double steps = std::nearbyint(std::ldexp(static_cast<double>(value), static_cast<int>(grid)));
  return static_cast<std::int32_t>(std::clamp(steps, -limit, limit));
}

float Shrink(std::int32_t value, unsigned bits) {
  return std::ldexp(static_cast<float>(value), -static_cast<int>(bits));
}

// The most steps that a component other than the largest can have: 2^turn / √2.
std::int32_t FindMostSteps(unsigned turn) { return (46341 >> (kFinestTurn - turn)) + 1; }

// 1 − a² − b² − c², the square of the component left out.
float FindSquareLeft(const QuantisedPose& pose) {
  const float a = Shrink(pose.a, pose.grid.turn), b = Shrink(pose.b, pose.grid.turn),
              c = Shrink(pose.c, pose.grid.turn);
  return 1.0F - a * a - b * b - c * c;
}

}  // namespace

PoseGrid MakePoseGrid(unsigned grid, float size) {
  assert(grid <= kFinestGrid && size > 0);
  const int turn = std::clamp(static_cast<int>(grid) + FindExponent(size) + 1, int{kCoarsestTurn}, int{kFinestTurn});
  return {grid, static_cast<unsigned>(turn)};
}

QuantisedPose Quantise(const Pose& pose, PoseGrid grid) {
  QuantisedPose result;
  result.grid = grid;
  result.x = QuantiseCoordinate(pose.centroid.x, grid.grid);
  result.y = QuantiseCoordinate(pose.centroid.y, grid.grid);
  result.z = QuantiseCoordinate(pose.centroid.z, grid.grid);

  std::array<float, 4> q{pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z};
  const float length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
  if (!(length > 0.0F)) q = {1.0F, 0.0F, 0.0F, 0.0F};
  for (std::uint32_t i = 1; i < 4; ++i) {
    if (std::fabs(q[i]) > std::fabs(q[result.largest])) result.largest = i;
  }
  const float sign = q[result.largest] < 0.0F ? -1.0F : 1.0F;
  const float scale = std::ldexp(length > 0.0F ? sign / length : sign, static_cast<int>(grid.turn));
  const auto most = static_cast<float>(FindMostSteps(grid.turn));
  const std::array<std::int32_t*, 3> fields{&result.a, &result.b, &result.c};
  std::size_t next = 0;
  for (std::uint32_t i = 0; i < 4; ++i) {
    if (i == result.largest) continue;
    *fields[next++] = static_cast<std::int32_t>(std::clamp(std::nearbyint(q[i] * scale), -most, most));
  }
  return result;
}

Pose Dequantise(const QuantisedPose& pose) {
  Pose result;
  const unsigned grid = pose.grid.grid, turn = pose.grid.turn;
  result.centroid = {Shrink(pose.x, grid), Shrink(pose.y, grid), Shrink(pose.z, grid)};
  const float left = std::sqrt(std::max(FindSquareLeft(pose), 0.0F));
  std::array<float, 4> q{};
  const std::array<float, 3> others{Shrink(pose.a, turn), Shrink(pose.b, turn), Shrink(pose.c, turn)};
  std::size_t next = 0;
  for (std::uint32_t i = 0; i < 4; ++i) q[i] = i == pose.largest ? left : others[next++];
  result.rotation = {q[0], q[1], q[2], q[3]};
  return result;
}

void WritePose(RangeEncoder& encoder, const QuantisedPose& pose) {
  for (const std::int32_t value : {pose.x, pose.y, pose.z}) WriteCoordinate(encoder, value);
  encoder.EncodeBits(pose.largest, 2);
  const std::int32_t most = FindMostSteps(pose.grid.turn);
  for (const std::int32_t value : {pose.a, pose.b, pose.c}) {
    encoder.EncodeUniform(static_cast<std::uint32_t>(value + most), static_cast<std::uint32_t>(2 * most + 1));
  }
}

bool ReadPose(RangeDecoder& decoder, QuantisedPose& pose) {
  for (std::int32_t* value : {&pose.x, &pose.y, &pose.z}) {
    *value = ReadCoordinate(decoder);
    // 31 bits reach further than the world does on any but the finest grid.
    if (std::fabs(Shrink(*value, pose.grid.grid)) > static_cast<float>(kWorldHalfExtent)) return false;
  }
  pose.largest = decoder.DecodeBits(2);
  const std::int32_t most = FindMostSteps(pose.grid.turn);
  for (std::int32_t* value : {&pose.a, &pose.b, &pose.c}) {
    *value = static_cast<std::int32_t>(decoder.DecodeUniform(static_cast<std::uint32_t>(2 * most + 1))) - most;
  }
  // The component left out is the largest, so its square is at least a quarter. Anything less is no rotation; rounding
  // has some room.
  return FindSquareLeft(pose) > 0.2F;
}

}  // namespace wobble::protocol
