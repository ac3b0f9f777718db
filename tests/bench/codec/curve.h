// The rate–distortion curve of a method, and its interpolation.
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

// Codes the whole recording. The first few frames do not count, because methods with memory start without history.
[[nodiscard]] RatePoint MeasurePoint(const Recording& recording, const Method& method, double parameter);

// Bits per vertex at that error, linear in the logarithm of the error between the two neighbouring points: doubling the
// error saves one bit per coordinate. NaN outside the curve. errorPercent of the points ascends or descends.
[[nodiscard]] double FindBitsAt(const Curve& curve, double errorPercent);

// The fewest bits of all variants of a method at that error.
[[nodiscard]] double FindFewestBitsAt(const std::vector<Curve>& curves, double errorPercent);

}  // namespace wobble::bench
