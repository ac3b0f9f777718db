// A histogram with fixed bounds whose counts only grow.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace wobble::server {

// kBounds: a constexpr array of upper bounds, inclusive, ascending. counts[i] holds the values up to kBounds[i] and
// above the bound before; the last count holds the values above all bounds.
template <const auto& kBounds>
struct Bins {
  std::array<std::uint64_t, kBounds.size() + 1> counts{};
  double sum = 0;

  void Record(double value) {
    ++counts[static_cast<std::size_t>(std::ranges::lower_bound(kBounds, value) - kBounds.begin())];
    sum += value;
  }
};

}  // namespace wobble::server
