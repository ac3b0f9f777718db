// A static range coder: symbols of known frequency into bytes and back, in integers.
//
// Carries go back into the bytes already written (as in Martin 1979) instead of being kept out by a narrower range:
// that loses 0.1 bit a record less than the carry-less variant. The end is the shortest string of bytes that, with
// zeros behind it, lies in the last range: half a byte more than the symbols are worth. rANS was as dense, but writes
// from the back, which the encoder's contexts do not allow.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace wobble::protocol {

// Frequencies of a table add up to 2^kFrequencyBits.
inline constexpr unsigned kFrequencyBits = 12;
inline constexpr std::uint32_t kFrequencyTotal = 1U << kFrequencyBits;

class RangeEncoder {
 public:
  // Appends to `bytes`, which must outlive the encoder.
  explicit RangeEncoder(std::vector<std::uint8_t>& bytes) : m_bytes(bytes), m_begin(bytes.size()) {}

  // A symbol that takes up [start, start + frequency) of kFrequencyTotal; frequency > 0.
  void Encode(std::uint32_t start, std::uint32_t frequency) {
    m_range >>= kFrequencyBits;
    Narrow(start, frequency);
  }
  // value < count, all equally likely; 1 <= count <= 2^17.
  void EncodeUniform(std::uint32_t value, std::uint32_t count) {
    m_range /= count;
    Narrow(value, 1);
  }
  // value < 2^bits, bits <= 16.
  void EncodeBits(std::uint32_t value, unsigned bits) {
    m_range >>= bits;
    Narrow(value, 1);
  }
  // Once, at the end; at least one byte is then there.
  void Finish();

 private:
  void Narrow(std::uint32_t start, std::uint32_t width);
  void AddCarry();

  std::vector<std::uint8_t>& m_bytes;
  std::size_t m_begin;
  std::uint32_t m_low = 0;
  std::uint32_t m_range = 0xFFFFFFFF;
};

// For bytes that anyone may have sent: every question has an answer within its bounds, past the end as well.
class RangeDecoder {
 public:
  explicit RangeDecoder(std::span<const std::uint8_t> bytes) : m_bytes(bytes) {
    for (int i = 0; i < 4; ++i) m_code = m_code << 8 | NextByte();
  }

  // Where in [0, kFrequencyTotal) the next symbol lies; Take is to follow with the symbol that has this place.
  std::uint32_t Find() {
    m_range >>= kFrequencyBits;
    const std::uint32_t place = m_code / m_range;
    return place < kFrequencyTotal ? place : kFrequencyTotal - 1;
  }
  void Take(std::uint32_t start, std::uint32_t frequency) {
    m_code -= start * m_range;
    m_range *= frequency;
    Refill();
  }
  std::uint32_t DecodeUniform(std::uint32_t count) {
    m_range /= count;
    std::uint32_t value = m_code / m_range;
    if (value >= count) value = count - 1;
    m_code -= value * m_range;
    Refill();
    return value;
  }
  std::uint32_t DecodeBits(unsigned bits) {
    m_range >>= bits;
    std::uint32_t value = m_code / m_range;
    if (value >> bits != 0) value = (1U << bits) - 1;
    m_code -= value * m_range;
    Refill();
    return value;
  }
  // No stream of an encoder makes the reader look further than four bytes past its end, nor leaves whole bytes unread.
  [[nodiscard]] bool Overran() const { return m_next > m_bytes.size() + 4; }
  [[nodiscard]] bool LeftBytes() const { return m_next < m_bytes.size(); }

 private:
  std::uint32_t NextByte() {
    const std::size_t at = m_next++;
    return at < m_bytes.size() ? m_bytes[at] : 0;
  }
  void Refill() {
    while (m_range < 1U << 24) {
      m_code = m_code << 8 | NextByte();
      m_range <<= 8;
    }
  }

  std::span<const std::uint8_t> m_bytes;
  std::size_t m_next = 0;
  std::uint32_t m_code = 0;
  std::uint32_t m_range = 0xFFFFFFFF;
};

}  // namespace wobble::protocol
