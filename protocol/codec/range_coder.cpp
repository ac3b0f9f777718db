#include "protocol/codec/range_coder.h"

namespace wobble::protocol {

void RangeEncoder::Narrow(std::uint32_t start, std::uint32_t width) {
  const std::uint32_t before = m_low;
  m_low += start * m_range;
  if (m_low < before) AddCarry();
  m_range *= width;
  while (m_range < 1U << 24) {
    m_bytes.push_back(static_cast<std::uint8_t>(m_low >> 24));
    m_low <<= 8;
    m_range <<= 8;
  }
}

// The range never leaves that of the bytes written so far, so one of them always takes the carry.
void RangeEncoder::AddCarry() {
  std::size_t at = m_bytes.size();
  while (at > m_begin && ++m_bytes[--at] == 0) {
  }
}

void RangeEncoder::Finish() {
  const std::uint64_t end = std::uint64_t{m_low} + m_range;
  for (unsigned count = 0; count <= 4; ++count) {
    const std::uint64_t below = (std::uint64_t{1} << (32 - 8 * count)) - 1;
    const std::uint64_t value = (m_low + below) & ~below;
    if (value >= end) continue;
    if (value >> 32 != 0) AddCarry();
    for (unsigned i = 0; i < count; ++i) m_bytes.push_back(static_cast<std::uint8_t>(value >> (24 - 8 * i)));
    break;
  }
  if (m_bytes.size() == m_begin) m_bytes.push_back(0);
}

}  // namespace wobble::protocol
