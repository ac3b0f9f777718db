#include "protocol/codec/range_coder.h"

namespace wobble::protocol {

void RangeWriter::Finish() {
  const std::uint64_t end = std::uint64_t{m_low} + m_range;
  for (unsigned count = 0; count <= 4; ++count) {
    const std::uint64_t below = (std::uint64_t{1} << (32 - 8 * count)) - 1;
    const std::uint64_t value = (m_low + below) & ~below;
    if (value >= end) continue;
    if (value >> 32 != 0) AddCarry(m_at);
    for (unsigned i = 0; i < count; ++i) *m_at++ = static_cast<std::uint8_t>(value >> (24 - 8 * i));
    break;
  }
}

void RangeEncoder::MakeRoom() {
  const auto written = m_writer.At() - m_bytes.data();
  m_bytes.resize(m_bytes.size() + kRoom);
  m_writer.MoveTo(m_bytes.data() + written);
}

void RangeEncoder::Finish() {
  Writer().Finish();
  m_bytes.resize(static_cast<std::size_t>(m_writer.At() - m_bytes.data()));
  if (m_bytes.size() == m_begin) m_bytes.push_back(0);
}

}  // namespace wobble::protocol
