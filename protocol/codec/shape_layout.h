// The parts of the shape format that encoder and decoder share, besides poses and contexts: the fields before the
// coefficients, the steps, and the contact prediction.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/codec/contexts.h"
#include "protocol/codec/pose.h"
#include "protocol/codec/shape_codec.h"

namespace wobble::protocol {

// Which tools a record is coded with.
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
// The largest coefficient, in steps.
inline constexpr std::uint32_t kMaxMagnitude = 1U << 20;

// size: of the blueprint, m.
void WriteHead(RangeEncoder& encoder, float size, const ShapeHead& head);
// Any bytes are safe.
[[nodiscard]] DecodeResult ReadHead(RangeDecoder& decoder, float size, ShapeHead& head);

// log2 of the quantiser step in metres, in eighths.
[[nodiscard]] inline int FindStepLevel(unsigned grid, unsigned stepIndex) {
  return static_cast<int>(stepIndex) - 8 * static_cast<int>(grid);
}
// The quantiser step, m: 2^(stepLevel / 8) rounded, the same on both ends to the bit.
[[nodiscard]] inline float FindStep(int stepLevel) {
  // 2^15 · 2^(i/8), rounded.
  constexpr std::array<std::int32_t, 8> kEighths = {32768, 35734, 38968, 42495, 46341, 50535, 55109, 60097};
  return std::ldexp(static_cast<float>(kEighths[static_cast<unsigned>(stepLevel) & 7]), (stepLevel >> 3) - 15);
}

// Predicts what contact does to the shape: presses the rest shape out of the sides and projects the motion onto each
// mode. False when the rest shape touches no side; `contact` is then unspecified. The model has a basis.
[[nodiscard]] bool FindContact(const PatchModel& model, std::span<const Side> sides, ContactScratch& contact);
// The prediction of one coefficient, in sixteenths of the step. along: of ContactScratch; gain: of the basis; scale:
// FindContactScale.
[[nodiscard]] inline std::int32_t FindSuggestion(std::int32_t along, std::int8_t gain, float scale) {
  const float suggested = static_cast<float>(along) * static_cast<float>(gain) * scale;
  constexpr float kMost = 1048576.0F;
  return static_cast<std::int32_t>(std::nearbyint(suggested < -kMost ? -kMost : suggested > kMost ? kMost : suggested));
}
// Turns along · gain into sixteenths of the step. size: of the blueprint, m.
[[nodiscard]] inline float FindContactScale(float size, float step) {
  return std::ldexp(1.0F, FindExponent(size) - 28) / step;
}

// The dot product of a column and as many numbers: exact as long as it fits, else modulo 2^32.
[[nodiscard]] inline std::int32_t Project(std::span<const std::int16_t> column, const std::int16_t* numbers) {
  std::uint32_t sum = 0;
  for (std::size_t i = 0; i < column.size(); ++i) {
    sum += static_cast<std::uint32_t>(int{column[i]} * int{numbers[i]});
  }
  return static_cast<std::int32_t>(sum);
}
// Three such products, with rows of numbers that begin `apart` numbers behind each other: the column is read once.
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
