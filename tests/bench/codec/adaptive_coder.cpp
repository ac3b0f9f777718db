// A carry is added to the bytes already written (Martin 1979): at most once per byte, and all bytes are still in
// memory.
#include "tests/bench/codec/adaptive_coder.h"

#include <bit>
#include <cstdlib>

namespace wobble::bench {
namespace {

constexpr std::uint32_t kLeastRange = 1U << 24;

}  // namespace

void AdaptiveEncoder::Shift() {
  if (m_low >> 32 != 0) {
    std::size_t i = m_bytes.size();
    while (++m_bytes[--i] == 0) {
    }
  }
  m_bytes.push_back(static_cast<std::uint8_t>(m_low >> 24));
  m_low = (m_low << 8) & 0xFFFFFFFFU;
  m_range <<= 8;
}

void AdaptiveEncoder::Write(bool bit, BitModel& model) {
  const std::uint32_t zero = (m_range >> 16) * model.ReadZero();
  if (bit) {
    m_low += zero;
    m_range -= zero;
  } else {
    m_range = zero;
  }
  model.Update(bit);
  while (m_range < kLeastRange) Shift();
}

void AdaptiveEncoder::WriteEven(std::uint32_t value, unsigned count) {
  while (count-- > 0) {
    m_range >>= 1;
    if ((value >> count & 1) != 0) m_low += m_range;
    while (m_range < kLeastRange) Shift();
  }
}

std::vector<std::uint8_t> AdaptiveEncoder::Finish() {
  // Any number within the range decodes correctly; choose the one with the most trailing zeros.
  m_low = (m_low + 0xFFFFFFU) & ~std::uint64_t{0xFFFFFFU};
  for (int i = 0; i < 4; ++i) Shift();
  while (!m_bytes.empty() && m_bytes.back() == 0) m_bytes.pop_back();
  return std::move(m_bytes);
}

AdaptiveDecoder::AdaptiveDecoder(std::span<const std::uint8_t> bytes) : m_bytes(bytes) {
  for (int i = 0; i < 4; ++i) m_code = m_code << 8 | Next();
}

bool AdaptiveDecoder::Read(BitModel& model) {
  const std::uint32_t zero = (m_range >> 16) * model.ReadZero();
  const bool bit = m_code >= zero;
  if (bit) {
    m_code -= zero;
    m_range -= zero;
  } else {
    m_range = zero;
  }
  model.Update(bit);
  for (; m_range < kLeastRange; m_range <<= 8) m_code = m_code << 8 | Next();
  return bit;
}

std::uint32_t AdaptiveDecoder::ReadEven(unsigned count) {
  std::uint32_t value = 0;
  while (count-- > 0) {
    m_range >>= 1;
    const bool bit = m_code >= m_range;
    if (bit) m_code -= m_range;
    value = value << 1 | static_cast<std::uint32_t>(bit);
    for (; m_range < kLeastRange; m_range <<= 8) m_code = m_code << 8 | Next();
  }
  return value;
}

void NumberModel::Write(int number, AdaptiveEncoder& encoder) {
  encoder.Write(number != 0, m_zero);
  if (number == 0) return;
  encoder.Write(number < 0, m_sign);
  const auto magnitude = static_cast<std::uint32_t>(std::abs(number));
  const auto bits = static_cast<unsigned>(std::bit_width(magnitude));
  for (unsigned i = 1; i < kMaxBits; ++i) {
    encoder.Write(bits > i, m_longer[i]);
    if (bits == i) break;
  }
  std::size_t path = 1;
  for (unsigned left = bits - 1, taken = 0; left > 0; --left, ++taken) {
    if (taken == 2) return encoder.WriteEven(magnitude & ((1U << left) - 1), left);
    const bool bit = (magnitude >> (left - 1) & 1) != 0;
    encoder.Write(bit, m_high[bits][path]);
    path = 2 * path + (bit ? 1 : 0);
  }
}

int NumberModel::Read(AdaptiveDecoder& decoder) {
  if (!decoder.Read(m_zero)) return 0;
  const bool isNegative = decoder.Read(m_sign);
  unsigned bits = 1;
  while (bits < kMaxBits && decoder.Read(m_longer[bits])) ++bits;
  std::uint32_t magnitude = 1;
  std::size_t path = 1;
  for (unsigned left = bits - 1, taken = 0; left > 0; --left, ++taken) {
    if (taken == 2) {
      magnitude = magnitude << left | decoder.ReadEven(left);
      break;
    }
    const bool bit = decoder.Read(m_high[bits][path]);
    magnitude = magnitude << 1 | static_cast<std::uint32_t>(bit);
    path = 2 * path + (bit ? 1 : 0);
  }
  return isNegative ? -static_cast<int>(magnitude) : static_cast<int>(magnitude);
}

}  // namespace wobble::bench
