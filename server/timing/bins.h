// How many values fell into which range, for histograms that only ever grow.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

namespace wobble::server {

// kBounds: a constant array of upper bounds, inclusive, ascending; what is above the last has a range of its own.
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
