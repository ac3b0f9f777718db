// A small adaptive arithmetic coder: bits with probabilities learnt from the bits before, and numbers made of such
// bits, as in LZMA and CABAC.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace wobble::bench {

// Probability that a bit is 0, in 1/65,536: the mean of a fast and a slow exponential average (windows of 16 and 128
// bits).
class BitModel {
 public:
  [[nodiscard]] std::uint32_t ReadZero() const { return (std::uint32_t{m_fast} + m_slow) >> 1; }
  void Update(bool bit) {
    m_fast = Move(m_fast, bit, 4);
    m_slow = Move(m_slow, bit, 7);
  }

 private:
  static std::uint16_t Move(std::uint16_t zero, bool bit, int shift) {
    const int target = bit ? 256 : 65536 - 256;  // keeps both probabilities above zero
    return static_cast<std::uint16_t>(zero + (target - zero) / (1 << shift));
  }
  std::uint16_t m_fast = 32768;
  std::uint16_t m_slow = 32768;
};

class AdaptiveEncoder {
 public:
  void Write(bool bit, BitModel& model);
  void WriteEven(std::uint32_t value, unsigned count);  // `count` equiprobable bits, highest first
  [[nodiscard]] std::vector<std::uint8_t> Finish();     // without trailing zeros, which the decoder supplies

 private:
  void Shift();

  std::vector<std::uint8_t> m_bytes;
  std::uint64_t m_low = 0;
  std::uint32_t m_range = 0xFFFFFFFFU;
};

class AdaptiveDecoder {
 public:
  explicit AdaptiveDecoder(std::span<const std::uint8_t> bytes);
  [[nodiscard]] bool Read(BitModel& model);
  [[nodiscard]] std::uint32_t ReadEven(unsigned count);

 private:
  std::uint8_t Next() { return m_next < m_bytes.size() ? m_bytes[m_next++] : std::uint8_t{0}; }

  std::span<const std::uint8_t> m_bytes;
  std::size_t m_next = 0;
  std::uint32_t m_range = 0xFFFFFFFFU;
  std::uint32_t m_code = 0;
};

// Codes signed numbers: a zero flag, the sign, the bit count, then the bits; the two highest bits after the leading one
// are adaptive, the rest equiprobable.
class NumberModel {
 public:
  void Write(int number, AdaptiveEncoder& encoder);
  [[nodiscard]] int Read(AdaptiveDecoder& decoder);

 private:
  static constexpr unsigned kMaxBits = 17;
  BitModel m_zero;
  BitModel m_sign;
  std::array<BitModel, kMaxBits + 1> m_longer;
  std::array<std::array<BitModel, 4>, kMaxBits + 1> m_high;
};

}  // namespace wobble::bench
