#include "protocol/codec/encoding/coefficient_writer.h"

#include <algorithm>

namespace wobble::protocol {
namespace {

// Takes and returns the writer, rather than its address: so that the loop of all coefficients has it in registers.
RangeWriter WriteEscape(RangeWriter encoder, std::uint32_t rest) {
  const auto length = static_cast<unsigned>(std::bit_width(rest + 1) - 1);
  for (unsigned i = 0; i < length; ++i) encoder.EncodeBits(1, 1);
  if (length < 20) encoder.EncodeBits(0, 1);
  const std::uint32_t number = rest + 1 - (1U << length);
  const unsigned high = length > 16 ? length - 16 : 0;
  encoder.EncodeBits(number & ((1U << (length - high)) - 1), length - high);
  encoder.EncodeBits(number >> (length - high), high);
  return encoder;
}

void WriteCoefficient(RangeWriter& encoder, Contexts& contexts, const ExpectedContext& expected, std::int32_t value) {
  const std::size_t context = contexts.Find(expected);
  const auto magnitude = static_cast<std::uint32_t>(value < 0 ? -value : value);
  const unsigned lowBits = FindLowBits(context);
  const std::uint32_t high = magnitude >> lowBits;
  const Frequency frequency = FindFrequencies(context)[std::min(high, kEscapeMagnitude)];
  encoder.Encode(frequency.start, frequency.size);
  if (high >= kEscapeMagnitude) encoder = WriteEscape(encoder, high - kEscapeMagnitude);
  if (lowBits > 0) encoder.EncodeBits(magnitude & ((1U << lowBits) - 1), lowBits);
  contexts.Add(magnitude);
  // The sign; of 0 no bits, which take no branch that is often mispredicted.
  encoder.EncodeBits(value < 0 ? 1 : 0, value != 0 ? 1 : 0);
}

}  // namespace

void WriteShape(float size, const ShapeHead& head, std::span<const ExpectedContext> expected,
                std::span<const std::int32_t> coefficients, std::vector<std::uint8_t>& out) {
  RangeEncoder encoder(out);
  WriteHead(encoder, size, head);
  Contexts contexts;
  RangeWriter writer = encoder.TakeWriter();
  for (std::size_t k = 0; k < coefficients.size(); ++k) {
    if (encoder.FindRoom(writer) < RangeEncoder::kWriterRoom) {
      encoder.Return(writer);
      writer = encoder.TakeWriter();
    }
    WriteCoefficient(writer, contexts, expected[k], coefficients[k]);
  }
  encoder.Return(writer);
  encoder.Finish();
}

}  // namespace wobble::protocol
