// The context model of the entropy coder: how large the next coefficient probably is, and what each magnitude costs.
//
// The estimate joins two facts: how large this coefficient was in training relative to the step (its level), and how
// large the coefficients before it in this record are relative to their own estimates. Two running sums, over about 8
// and 32 coefficients, hold the second; the geometric mean of their ratios scales the first. The product, on a scale of
// 3/8 octave, is the context, and each context has a fixed table of frequencies. Without the running sums records take
// 7 % more; more contexts (the last two magnitudes, level and sums apart: 200 tables) saved under 0.4 %.
#pragma once

#include <array>
#include <bit>
#include <cstdint>

#include "protocol/range_coder.h"

namespace wobble::protocol {

inline constexpr std::size_t kContexts = 36;
// Magnitudes 0 … 14 of a coefficient without its low bits, and an escape for all larger ones.
inline constexpr std::size_t kMagnitudes = 16;
inline constexpr std::uint32_t kEscapeMagnitude = kMagnitudes - 1;

// Levels: log2 of a coefficient's spread in training over the step, in eighths of an octave; 0 when they are equal.
inline constexpr int kLowestLevel = -40;
inline constexpr int kHighestLevel = 80;

// About 8 log2(x), for x >= 1: eight times the place of its highest bit plus the three bits behind it. In integers, so
// that both ends agree.
[[nodiscard]] inline int FindLogarithm(std::uint32_t x) {
  const int octave = std::bit_width(x) - 1;
  return 8 * octave + static_cast<int>((x << (31 - octave)) >> 28 & 7);
}

// The expected magnitude at a level, in 2^-12 steps; for every second level from kLowestLevel on.
extern const std::array<std::uint32_t, (kHighestLevel - kLowestLevel) / 2 + 1> kExpectations;
[[nodiscard]] inline std::uint32_t FindExpectation(int level) {
  return kExpectations[static_cast<std::size_t>(level - kLowestLevel) / 2];
}

struct Frequency {
  std::uint16_t start = 0;
  std::uint16_t size = 0;
};
// The frequencies of all magnitudes in a context, which add up to kFrequencyTotal.
[[nodiscard]] const std::array<Frequency, kMagnitudes>& FindFrequencies(std::size_t context);
// The number of low bits of a coefficient that are written as they are.
[[nodiscard]] constexpr unsigned FindLowBits(std::size_t context) {
  return context > 24 ? (static_cast<unsigned>(context) - 22) / 3 : 0;
}

// The running sums of one record.
class Contexts {
 public:
  // The context of the next coefficient. level: its level, within kLowestLevel … kHighestLevel.
  [[nodiscard]] std::size_t Find(int level) {
    m_expected = FindExpectation(level);
    const int gain = FindLogarithm(m_seenShort) - FindLogarithm(m_expectedShort) + FindLogarithm(m_seenLong) -
                     FindLogarithm(m_expectedLong);
    const int likely = FindLogarithm(m_expected) + (gain >> 1) - kUnit;
    const int place = likely + kOffset;
    if (place < 0) return 0;
    return static_cast<std::size_t>(place) / 3 < kContexts ? static_cast<std::size_t>(place) / 3 : kContexts - 1;
  }
  // Adds the magnitude, in steps, of the coefficient that the last Find was about.
  void Add(std::uint32_t magnitude) {
    const std::uint32_t seen = (magnitude < kCap ? magnitude : kCap) << 12;
    m_seenShort += seen + kShort - (m_seenShort >> 3);
    m_expectedShort += m_expected + kShort - (m_expectedShort >> 3);
    m_seenLong += seen + kLong - (m_seenLong >> 5);
    m_expectedLong += m_expected + kLong - (m_expectedLong >> 5);
  }

 private:
  static constexpr int kUnit = 96;    // the logarithm of 1 in 2^-12
  static constexpr int kOffset = 55;  // context 0 begins 55 eighths of an octave below 1
  static constexpr std::uint32_t kCap = 1023;
  // Added to the sums with each coefficient: over zeros alone they tend to 4096, one coefficient of magnitude 1.
  static constexpr std::uint32_t kShort = 4096 >> 3, kLong = 4096 >> 5;

  std::uint32_t m_expected = 0;
  std::uint32_t m_seenShort = 4096, m_expectedShort = 4096;
  std::uint32_t m_seenLong = 4096, m_expectedLong = 4096;
};

}  // namespace wobble::protocol
