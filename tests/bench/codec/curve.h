// Bits against error of one method, and what it would take at an error that none of its points has.
#pragma once

#include <string>
#include <vector>

#include "tests/bench/codec/method.h"

namespace wobble::bench {

struct RatePoint {
  double parameter = 0;
  double bitsPerVertex = 0;
  double errorPercent = 0;      // RMS over vertices, bodies and frames, % of the body's size
  double errorPercentP999 = 0;  // 99.9th percentile over them
};

using Curve = std::vector<RatePoint>;

// Over all frames but the first few, which methods that remember have nothing to remember for.
[[nodiscard]] RatePoint MeasurePoint(const Recording& recording, const Method& method, double parameter);

// On the straight line over the logarithm of the error between the two points next to it: bits fall by one a
// coordinate when the error doubles. Not a number outside of the curve. errorPercent ascending or descending.
[[nodiscard]] double FindBitsAt(const Curve& curve, double errorPercent);

// At each error the method that takes fewest bits, for one that has variants.
[[nodiscard]] double FindFewestBitsAt(const std::vector<Curve>& curves, double errorPercent);

}  // namespace wobble::bench
