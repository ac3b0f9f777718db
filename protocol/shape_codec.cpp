#include "protocol/shape_codec.h"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstdlib>

#include "protocol/bits.h"
#include "protocol/pose.h"

namespace wobble::protocol {
namespace {

// Steps m·2^-e with four mantissas an octave: exact in every float, so no two decoders differ.
constexpr unsigned kStepBits = 7;
constexpr unsigned kFinestStep = 95;  // 2^-23 m
float StepSize(unsigned index) {
  const auto mantissa = static_cast<float>(7 - (index & 3)) / 4.0F;
  return std::ldexp(mantissa, -static_cast<int>(index >> 2));
}

// A quotient of this many ones is followed by the value in kEscapeBits instead of a remainder.
constexpr unsigned kEscape = 24;
constexpr unsigned kEscapeBits = 22;
constexpr std::int32_t kMaxResidual = (1 << (kEscapeBits - 1)) - 1;

std::uint32_t FoldSign(std::int32_t value) {
  return (static_cast<std::uint32_t>(value) << 1) ^ static_cast<std::uint32_t>(value >> 31);
}
std::int32_t UnfoldSign(std::uint32_t value) {
  return static_cast<std::int32_t>(value >> 1) ^ -static_cast<std::int32_t>(value & 1);
}

// The Rice parameter follows the magnitudes seen: k is the smallest with count·2^k ≥ sum. Both ends step it alike.
class RiceState {
 public:
  [[nodiscard]] unsigned Parameter() const {
    unsigned k = 0;
    while ((std::uint64_t{m_count} << k) < m_sum) ++k;
    return std::min(k, kEscapeBits);
  }
  void Update(std::uint32_t folded) {
    m_sum += folded;
    if (++m_count == 32) {  // halved now and then, so that it follows the patch from calm to busy vertices
      m_sum >>= 1;
      m_count >>= 1;
    }
  }

 private:
  std::uint64_t m_sum = 8;
  std::uint32_t m_count = 1;
};

void WriteResidual(BitWriter& writer, RiceState& state, std::int32_t residual) {
  const std::uint32_t folded = FoldSign(residual);
  const unsigned k = state.Parameter();
  const std::uint32_t quotient = folded >> k;
  if (quotient < kEscape) {
    writer.Write((1U << quotient) - 1, quotient + 1);  // ones, then a zero
    writer.Write(folded & ((1U << k) - 1), k);
  } else {
    writer.Write((1U << kEscape) - 1, kEscape);
    writer.Write(folded, kEscapeBits);
  }
  state.Update(folded);
}

bool ReadResidual(BitReader& reader, RiceState& state, std::int32_t& residual) {
  const unsigned k = state.Parameter();
  unsigned quotient = 0;
  while (quotient < kEscape && reader.Read(1) == 1) ++quotient;
  std::uint32_t folded = 0;
  if (quotient < kEscape) {
    const std::uint64_t wide = (std::uint64_t{quotient} << k) | reader.Read(k);
    if (wide >> kEscapeBits != 0) return false;
    folded = static_cast<std::uint32_t>(wide);
  } else {
    folded = reader.Read(kEscapeBits);
  }
  state.Update(folded);
  residual = UnfoldSign(folded);
  return true;
}

// The vertex as every decoder computes it.
Vector3 Reconstruct(Vector3 rest, std::int32_t x, std::int32_t y, std::int32_t z, float step) {
  return {rest.x + static_cast<float>(x) * step, rest.y + static_cast<float>(y) * step,
          rest.z + static_cast<float>(z) * step};
}

std::int32_t QuantiseResidual(float value, float step) {
  assert(!std::isnan(value));
  const float grid = std::nearbyint(value / step);
  return static_cast<std::int32_t>(
      std::clamp(grid, -static_cast<float>(kMaxResidual), static_cast<float>(kMaxResidual)));
}

// Writes the payload at one step. The error is exact: rotation keeps lengths, so it is measured in the body frame.
ShapeEncoding EncodeAtStep(const QuantisedPose& pose, std::span<const Vector3> rest, std::span<const Vector3> vertices,
                           unsigned stepIndex, std::vector<std::uint8_t>& out) {
  const Pose seen = Dequantise(pose);
  const Quaternion inverse = Conjugate(seen.rotation);
  ShapeEncoding result{true, StepSize(stepIndex)};

  BitWriter writer(out);
  WritePose(writer, pose);
  writer.Write(stepIndex, kStepBits);
  RiceState state;
  double sum = 0;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    const Vector3 local = Rotate(inverse, vertices[i] - seen.centroid);
    const Vector3 departure = local - rest[i];
    const std::int32_t x = QuantiseResidual(departure.x, result.step);
    const std::int32_t y = QuantiseResidual(departure.y, result.step);
    const std::int32_t z = QuantiseResidual(departure.z, result.step);
    WriteResidual(writer, state, x);
    WriteResidual(writer, state, y);
    WriteResidual(writer, state, z);
    const Vector3 error = Reconstruct(rest[i], x, y, z, result.step) - local;
    const float square = Dot(error, error);
    sum += square;
    result.maxError = std::max(result.maxError, square);
  }
  writer.Align();
  result.maxError = std::sqrt(result.maxError);
  result.rmsError = static_cast<float>(std::sqrt(sum / static_cast<double>(rest.size())));
  return result;
}

}  // namespace

ShapeEncoding EncodeShape(const Pose& pose, std::span<const Vector3> rest, std::span<const Vector3> vertices,
                          float targetRms, std::size_t maxBytes, std::vector<std::uint8_t>& out) {
  assert(!rest.empty() && rest.size() == vertices.size() && targetRms > 0.0F);
  const QuantisedPose quantised = Quantise(pose);
  const std::size_t begin = out.size();

  // RMS is about step/2: start at the coarsest step not above twice the target, go finer if chance put it above.
  unsigned index = 0;
  while (index < kFinestStep && StepSize(index) > 2.0F * targetRms) ++index;
  bool tooLarge = false;
  for (;;) {
    const ShapeEncoding result = EncodeAtStep(quantised, rest, vertices, index, out);
    if (out.size() - begin > maxBytes) {
      tooLarge = true;
      out.resize(begin);
      if (index == 0) return {};
      --index;
    } else if (result.rmsError > targetRms && !tooLarge && index < kFinestStep) {
      out.resize(begin);
      ++index;
    } else {
      return result;
    }
  }
}

DecodeResult DecodeShape(std::span<const std::uint8_t> payload, std::span<const Vector3> rest, Pose& pose,
                         std::span<Vector3> shape) {
  assert(rest.size() == shape.size());
  BitReader reader(payload);
  QuantisedPose quantised;
  if (!ReadPose(reader, quantised)) return reader.Overran() ? DecodeResult::kTruncated : DecodeResult::kBadPose;
  const unsigned index = reader.Read(kStepBits);
  if (reader.Overran()) return DecodeResult::kTruncated;
  if (index > kFinestStep) return DecodeResult::kBadStep;
  const float step = StepSize(index);
  RiceState state;
  for (std::size_t i = 0; i < rest.size(); ++i) {
    std::int32_t x = 0, y = 0, z = 0;
    if (!ReadResidual(reader, state, x) || !ReadResidual(reader, state, y) || !ReadResidual(reader, state, z)) {
      return DecodeResult::kBadResidual;
    }
    if (reader.Overran()) return DecodeResult::kTruncated;
    shape[i] = Reconstruct(rest[i], x, y, z, step);
  }
  if (!reader.AtEnd()) return DecodeResult::kTrailingBytes;
  pose = Dequantise(quantised);
  return DecodeResult::kOk;
}

const char* Name(DecodeResult result) {
  switch (result) {
    case DecodeResult::kOk:
      return "ok";
    case DecodeResult::kTruncated:
      return "truncated";
    case DecodeResult::kBadPose:
      return "bad pose";
    case DecodeResult::kBadStep:
      return "bad step";
    case DecodeResult::kBadResidual:
      return "bad residual";
    case DecodeResult::kTrailingBytes:
      return "trailing bytes";
  }
  return "unknown";
}

}  // namespace wobble::protocol
