#include "protocol/codec/basis.h"

namespace wobble::protocol {
namespace {

class Writer {
 public:
  void Add8(std::uint8_t value) { bytes.push_back(value); }
  void Add16(std::uint16_t value) {
    bytes.push_back(static_cast<std::uint8_t>(value));
    bytes.push_back(static_cast<std::uint8_t>(value >> 8));
  }
  template <class Byte>
  void AddAll(const std::vector<Byte>& values) {
    for (const Byte value : values) Add8(static_cast<std::uint8_t>(value));
  }
  std::vector<std::uint8_t> bytes;
};

void WriteModes(const BasisSource& source, Writer& writer) {
  writer.Add16(static_cast<std::uint16_t>(source.modes.size() / source.CountRows()));
  writer.Add8(source.blocks);
  for (const std::uint16_t vertex : source.order) writer.Add16(vertex);
  writer.AddAll(source.modes);
  for (std::size_t i = 0; i < source.turns.size(); i += 2) {
    const int high = i + 1 < source.turns.size() ? source.turns[i + 1] : 0;
    writer.Add8(static_cast<std::uint8_t>((source.turns[i] & 15) | (high & 15) << 4));
  }
}

}  // namespace

std::vector<std::uint8_t> WriteBasis(const BasisSource& source) {
  Writer writer;
  writer.Add8(static_cast<std::uint8_t>(source.kind));
  writer.Add16(source.vertices);
  if (source.kind == BasisSource::Kind::kCosine) {
    for (const std::uint16_t count : source.grid) writer.Add16(count);
  } else {
    WriteModes(source, writer);
  }
  writer.AddAll(source.levels);
  writer.AddAll(source.gains);
  return std::move(writer.bytes);
}

}  // namespace wobble::protocol
