// The parts of the shape format that encoder and decoder share, besides poses and contexts: the fields before the
// coefficients, the steps, and the contact prediction.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "protocol/codec/contexts.h"
#include "protocol/codec/mode_products.h"
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

// Presses the rest shape out of the sides: fills in all of `contact` but `along`. False when the rest shape touches no
// side; `contact` is then unspecified. The model has a basis.
[[nodiscard]] bool FindPressed(const PatchModel& model, std::span<const Side> sides, ContactScratch& contact);
// The rows of numbers, one for each coordinate (of a scalar basis: all x, then all y, then all z, each padded), and
// where the products go, in the order of coefficients. Returns their number, one or three.
std::size_t ListRows(const Basis& basis, const std::int16_t* numbers, std::int32_t* products,
                     std::array<ProductRow, 3>& rows);
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

// The values of modes, in sixteenths of the step, in the order of coefficients. along: of ContactScratch; empty without
// contact. scale: FindContactScale.
void FindValues(std::span<const std::int32_t> coefficients, std::span<const std::int32_t> along,
                std::span<const std::int8_t> gains, float scale, std::span<std::uint32_t> values);
// Moves vertices by sums of modes times a step, m. sums: in 2^-18 steps; of a scalar basis all x, then all y, then all
// z.
void MoveVertices(const PatchModel& model, std::span<const std::uint32_t> sums, float step, std::span<Vector3> shape);

}  // namespace wobble::protocol
