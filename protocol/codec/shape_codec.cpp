// All arithmetic up to the sum of modes is in integers that wrap: a record made to overflow decodes to nonsense, but to
// the same nonsense everywhere. The encoder decodes its own numbers and never sends any that overflow.
#include "protocol/codec/shape_codec.h"

#include <cassert>

#include "protocol/codec/contexts.h"
#include "protocol/codec/shape_layout.h"

namespace wobble::protocol {
namespace {

// An exponential Golomb code: up to twenty ones, then a number of as many bits. At most 2^21 − 2.
std::uint32_t ReadEscape(RangeDecoder& decoder) {
  unsigned length = 0;
  while (length < 20 && decoder.DecodeBit() == 1) ++length;
  const unsigned high = length > 16 ? length - 16 : 0;
  const std::uint32_t low = decoder.DecodeBits(length - high);
  return (1U << length) - 1 + (low | decoder.DecodeBits(high) << (length - high));
}

// False when it is too large.
bool ReadCoefficient(RangeDecoder& decoder, Contexts& contexts, const ExpectedContext& expected, std::int32_t& value) {
  const std::size_t context = contexts.Find(expected);
  const auto& frequencies = FindFrequencies(context);
  decoder.Begin();
  std::uint32_t magnitude = 0;
  while (magnitude < kEscapeMagnitude && decoder.Reaches(frequencies[magnitude + 1].start)) ++magnitude;
  decoder.Take(frequencies[magnitude].start, frequencies[magnitude].size);
  if (magnitude == kEscapeMagnitude) magnitude += ReadEscape(decoder);
  const unsigned lowBits = FindLowBits(context);
  if (lowBits > 0) magnitude = magnitude << lowBits | decoder.DecodeBits(lowBits);
  if (magnitude > kMaxMagnitude) return false;
  contexts.Add(magnitude);
  value = static_cast<std::int32_t>(magnitude);
  if (magnitude > 0 && decoder.DecodeBit() == 1) value = -value;
  return true;
}

// The shape without a basis: each coefficient moves one coordinate; coefficients are in steps.
void MoveCoordinates(std::span<const Vector3> rest, std::span<const std::int32_t> coefficients, float step,
                     std::span<Vector3> shape) {
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const std::int32_t* c = coefficients.data() + 3 * i;
    shape[i] = rest[i] + Vector3{static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2])} * step;
  }
}

}  // namespace

void FindValues(std::span<const std::int32_t> coefficients, std::span<const std::int32_t> along,
                std::span<const std::int8_t> gains, float scale, std::span<std::uint32_t> values) {
  for (std::size_t k = 0; k < values.size(); ++k) {
    std::uint32_t value = static_cast<std::uint32_t>(coefficients[k]) * 16;
    if (!along.empty()) value += static_cast<std::uint32_t>(FindSuggestion(along[k], gains[k], scale));
    values[k] = value;
  }
}

void MoveVertices(const PatchModel& model, std::span<const std::uint32_t> sums, float step, std::span<Vector3> shape) {
  const std::size_t count = model.rest.size(), apart = model.basis->isScalar ? count : 1;
  const std::size_t stride = model.basis->isScalar ? 1 : 3;
  const float unit = std::ldexp(step, -18);  // 2^-4 of a step times 2^-14 of a column
  const auto read = [&](std::size_t at) { return static_cast<float>(static_cast<std::int32_t>(sums[at])); };
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = i * stride;
    shape[i] = model.rest[i] + Vector3{read(at), read(at + apart), read(at + 2 * apart)} * unit;
  }
}

DecodeResult DecodePose(std::span<const std::uint8_t> payload, float size, QuantisedPose& pose) {
  RangeDecoder decoder(payload);
  ShapeHead head;
  const DecodeResult result = ReadHead(decoder, size, head);
  pose = head.pose;
  return result;
}

void ShapeDecoder::MoveAlongModes(const PatchModel& model, std::span<const std::int32_t> coefficients,
                                  std::span<const std::int32_t> along, float step, std::span<Vector3> shape) {
  const Basis& basis = *model.basis;
  const std::size_t count = model.rest.size();
  // Of a scalar basis the values along x, then those along y, then z.
  const std::size_t axes = basis.isScalar ? 3 : 1, rows = basis.Rows();
  m_values.resize(3 * count);
  FindValues(coefficients, along, basis.gains, FindContactScale(model.size, step), m_values);
  if (basis.isScalar) {
    m_sums.assign(m_values.begin(), m_values.end());
    for (std::size_t k = 0; k < 3 * count; ++k) m_values[k % 3 * rows + k / 3] = m_sums[k];
  }
  m_sums.assign(3 * count, 0);
  for (std::size_t axis = 0; axis < axes; ++axis) {
    m_modeSums.Add(basis, std::span(m_values).subspan(axis * rows, rows), m_sums.data() + axis * rows);
  }
  MoveVertices(model, m_sums, step, shape);
}

DecodeResult ShapeDecoder::Decode(const PatchModel& model, std::span<const std::uint8_t> payload, QuantisedPose& pose,
                                  std::span<Vector3> shape) {
  const std::size_t count = model.rest.size();
  assert(shape.size() == count && (model.basis == nullptr || model.basis->vertices == count));
  RangeDecoder decoder(payload);
  ShapeHead head;
  const DecodeResult headResult = ReadHead(decoder, model.size, head);
  if (headResult != DecodeResult::kOk) return headResult;
  const Basis* basis = head.mode.usesBasis ? model.basis : nullptr;
  if (head.mode.usesBasis && basis == nullptr) return DecodeResult::kBadMode;

  const int stepLevel = FindStepLevel(head.pose.grid.grid, head.stepIndex);
  const std::span<const ExpectedContext> expected = m_plans.Find(basis, 3 * count, stepLevel);
  Contexts contexts;
  m_coefficients.resize(3 * count);
  for (std::size_t k = 0; k < 3 * count; ++k) {
    if (!ReadCoefficient(decoder, contexts, expected[k], m_coefficients[k])) {
      return DecodeResult::kBadCoefficient;
    }
    if (decoder.Overran()) return DecodeResult::kTruncated;
  }
  if (decoder.LeftBytes()) return DecodeResult::kTrailingBytes;

  pose = head.pose;
  Rebuild(model, head, m_coefficients, nullptr, shape);
  return DecodeResult::kOk;
}

void ShapeDecoder::Rebuild(const PatchModel& model, const ShapeHead& head, std::span<const std::int32_t> coefficients,
                           const ContactScratch* contact, std::span<Vector3> shape) {
  m_sides.clear();
  if ((head.mode.followsContact && contact == nullptr) || head.mode.pressesOut) {
    FindSides(model.obstacles, Dequantise(head.pose), model.reach, m_sides);
  }
  const float step = FindStep(FindStepLevel(head.pose.grid.grid, head.stepIndex));
  if (head.mode.usesBasis) {
    std::span<const std::int32_t> along;
    if (head.mode.followsContact && contact != nullptr) {
      along = contact->along;
    } else if (head.mode.followsContact && FindContact(model, m_sides, m_contact)) {
      along = m_contact.along;
    }
    MoveAlongModes(model, coefficients, along, step, shape);
  } else {
    MoveCoordinates(model.rest, coefficients, step, shape);
  }
  if (head.mode.pressesOut) static_cast<void>(PressOut(m_sides, shape));
}

const char* Name(DecodeResult result) {
  switch (result) {
    case DecodeResult::kOk:
      return "ok";
    case DecodeResult::kTruncated:
      return "truncated";
    case DecodeResult::kBadMode:
      return "bad mode";
    case DecodeResult::kBadPose:
      return "bad pose";
    case DecodeResult::kBadStep:
      return "bad step";
    case DecodeResult::kBadCoefficient:
      return "bad coefficient";
    case DecodeResult::kTrailingBytes:
      return "trailing bytes";
  }
  return "unknown";
}

}  // namespace wobble::protocol
