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
#include <span>

#include "protocol/codec/range_coder.h"

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

// Holds what the levels alone say about the context of a coefficient; it is the same for all records of a basis and
// step.
struct ExpectedContext {
  std::int16_t magnitude = 0;  // the logarithm of its expectation, from the first context on
  std::int16_t sums = 0;       // the logarithms of both running sums of the expectations before it
};

// The running sums of one record.
class Contexts {
 public:
  // The context of the next coefficient.
  [[nodiscard]] std::size_t Find(const ExpectedContext& expected) const {
    const int gain = FindLogarithm(m_seen.brief) + FindLogarithm(m_seen.lasting) - expected.sums;
    const int place = expected.magnitude + (gain >> 1);
    if (place < 0) return 0;
    return static_cast<std::size_t>(place) / 3 < kContexts ? static_cast<std::size_t>(place) / 3 : kContexts - 1;
  }
  // Adds the magnitude, in steps, of the coefficient that the last Find was about.
  void Add(std::uint32_t magnitude) { m_seen.Add((magnitude < kCap ? magnitude : kCap) << 12); }

  // levels: of a record's coefficients, each within kLowestLevel … kHighestLevel; those of `expected` are overwritten.
  static void Expect(std::span<const int> levels, std::span<ExpectedContext> expected);

 private:
  static constexpr int kUnit = 96;    // the logarithm of 1 in 2^-12
  static constexpr int kOffset = 55;  // context 0 begins 55 eighths of an octave below 1
  static constexpr std::uint32_t kCap = 1023;

  // In 2^-12 steps.
  struct Sums {
    // Added with each coefficient: over zeros alone they tend to 4096, one coefficient of magnitude 1.
    static constexpr std::uint32_t kBrief = 4096 >> 3, kLasting = 4096 >> 5;
    std::uint32_t brief = 4096, lasting = 4096;  // over about 8 and 32 coefficients

    void Add(std::uint32_t value) {
      brief += value + kBrief - (brief >> 3);
      lasting += value + kLasting - (lasting >> 5);
    }
  };
  Sums m_seen;
};

}  // namespace wobble::protocol
