// What the shape encoder and decoder must do alike, besides poses and contexts: the fields before the coefficients, the
// steps, and what contact suggests.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/contexts.h"
#include "protocol/pose.h"
#include "protocol/shape_codec.h"

namespace wobble::protocol {

// How a record is coded.
struct ShapeMode {
  bool usesBasis = false;
  bool followsContact = false;  // only with a basis
  // Reserved: the encoder never sets it, because it brought nothing measurable; the decoder obeys it. Taking the bit
  // out would change the code of every record's mode and thereby the protocol's version.
  bool pressesOut = false;
};

struct ShapeHead {
  ShapeMode mode;
  unsigned stepIndex = 0;  // below kSteps
  QuantisedPose pose;
};
inline constexpr unsigned kSteps = 64;
// Of a coefficient coded without a basis.
inline constexpr int kPlainLevel = 16;
// A coefficient is at most this many steps.
inline constexpr std::uint32_t kMaxMagnitude = 1U << 20;

void WriteHead(RangeEncoder& encoder, float size, const ShapeHead& head);
[[nodiscard]] DecodeResult ReadHead(RangeDecoder& decoder, float size, ShapeHead& head);

// Eighths of an octave of a metre.
[[nodiscard]] inline int FindStepLevel(unsigned grid, unsigned stepIndex) {
  return static_cast<int>(stepIndex) - 8 * static_cast<int>(grid);
}
// 2^(stepLevel / 8) m, near enough, and the same for everyone.
[[nodiscard]] inline float FindStep(int stepLevel) {
  // 2^15 · 2^(i/8), rounded.
  constexpr std::array<std::int32_t, 8> kEighths = {32768, 35734, 38968, 42495, 46341, 50535, 55109, 60097};
  return std::ldexp(static_cast<float>(kEighths[static_cast<unsigned>(stepLevel) & 7]), (stepLevel >> 3) - 15);
}

[[nodiscard]] inline int FindLevel(const Basis* basis, std::size_t coefficient, int stepLevel) {
  if (basis == nullptr) return kPlainLevel;
  const int level = basis->levels[coefficient] - stepLevel;
  return level < kLowestLevel ? kLowestLevel : level > kHighestLevel ? kHighestLevel : level;
}

// Of a size, the smallest n with size < 2^n.
[[nodiscard]] inline int FindExponent(float size) {
  int exponent = 0;
  static_cast<void>(std::frexp(size, &exponent));
  return exponent;
}

// What contact suggests: the rest shape pressed out of the sides, along each mode. False when it touches none.
[[nodiscard]] bool FindContact(const PatchModel& model, std::span<const Side> sides, ContactScratch& contact);
// Of that, what a coefficient follows, in sixteenths of the step. scale: FindContactScale.
[[nodiscard]] inline std::int32_t FindSuggestion(std::int32_t along, std::int8_t gain, float scale) {
  const float suggested = static_cast<float>(along) * static_cast<float>(gain) * scale;
  constexpr float kMost = 1048576.0F;
  return static_cast<std::int32_t>(std::nearbyint(suggested < -kMost ? -kMost : suggested > kMost ? kMost : suggested));
}
[[nodiscard]] inline float FindContactScale(float size, float step) {
  return std::ldexp(1.0F, FindExponent(size) - 28) / step;
}

// Of a body's rest shape.
[[nodiscard]] inline float FindReach(std::span<const Vector3> rest) {
  float square = 0;
  for (const Vector3& v : rest) {
    const float each = Dot(v, v);
    if (each > square) square = each;
  }
  return std::sqrt(square);
}

// Products of a column and of one row of numbers, exact as long as they fit, else modulo 2^32.
[[nodiscard]] inline std::int32_t Project(std::span<const std::int16_t> column, const std::int16_t* numbers) {
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < column.size(); ++i) {
    sum += static_cast<std::uint32_t>(int{column[i]} * int{numbers[i]});
  }
  return static_cast<std::int32_t>(sum);
}
// The same of three rows, one `apart` numbers behind the other: a column is read once for all.
[[nodiscard]] inline std::array<std::int32_t, 3> ProjectAxes(std::span<const std::int16_t> column,
                                                             const std::int16_t* numbers, std::size_t apart) {
  std::uint32_t x = 0, y = 0, z = 0;
  for (std::size_t i = 0; i < column.size(); ++i) {
    const int each = column[i];
    x += static_cast<std::uint32_t>(each * int{numbers[i]});
    y += static_cast<std::uint32_t>(each * int{numbers[i + apart]});
    z += static_cast<std::uint32_t>(each * int{numbers[i + 2 * apart]});
  }
  return {static_cast<std::int32_t>(x), static_cast<std::int32_t>(y), static_cast<std::int32_t>(z)};
}

}  // namespace wobble::protocol
