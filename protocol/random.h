// Pseudo-random numbers that are the same on every machine and with every standard library.
#pragma once

#include <cstdint>

namespace wobble::protocol {

// SplitMix64 (Steele, Lea and Flood, 2014): any seed is good, and streams from neighbouring seeds are unrelated.
class Random {
 public:
  explicit Random(std::uint64_t seed) : m_state(seed) {}

  std::uint64_t Next() {
    m_state += 0x9E3779B97F4A7C15u;
    std::uint64_t z = m_state;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
  }

  // Uniform in [0, 1). Not std::uniform_real_distribution, whose results differ between standard libraries.
  double NextShare() { return static_cast<double>(Next() >> 11) * 0x1p-53; }

 private:
  std::uint64_t m_state;
};

}  // namespace wobble::protocol
