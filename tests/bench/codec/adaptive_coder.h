// A small adaptive arithmetic coder: bits with probabilities that follow what has been seen, and numbers made of such
// bits, as LZMA and CABAC have them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace wobble::bench {

// How likely a bit is 0, of 65,536: the mean of one estimate that adapts in a few bits and one that does in many.
class BitModel {
 public:
  [[nodiscard]] std::uint32_t ReadZero() const { return (std::uint32_t{m_fast} + m_slow) >> 1; }
  void Update(bool bit) {
    m_fast = Move(m_fast, bit, 4);
    m_slow = Move(m_slow, bit, 7);
  }

 private:
  static std::uint16_t Move(std::uint16_t zero, bool bit, int shift) {
    const int target = bit ? 256 : 65536 - 256;  // never quite certain
    return static_cast<std::uint16_t>(zero + (target - zero) / (1 << shift));
  }
  std::uint16_t m_fast = 32768;
  std::uint16_t m_slow = 32768;
};

class AdaptiveEncoder {
 public:
  void Write(bool bit, BitModel& model);
  void WriteEven(std::uint32_t value, unsigned count);  // bits of even chances, highest first
  [[nodiscard]] std::vector<std::uint8_t> Finish();     // without zeros at the end, which the decoder supplies

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

// Signed numbers: 0 or not, sign, how many bits, then these, of which the highest two after the first adapt.
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
