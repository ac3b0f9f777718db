// Roots whose bits no library decides: the C library's cube roots and hypotenuses differ between architectures in their
// last bits.
#pragma once

#include <cmath>

namespace wobble::physics {

// ³√x of a finite x ≥ 0, to rounding. Newton's method for a third root between 1/2 and 1; the last residual is computed
// to more than a double's digits, so its correction leaves an error hardly above half a unit in the last place.
[[nodiscard]] inline double FindCubeRoot(double x) {
  if (!(x > 0)) return 0;
  int exponent = 0;
  double m = std::frexp(x, &exponent);  // x = m 2^exponent
  while (exponent % 3 != 0) m /= 2, ++exponent;
  double y = (1 + 2 * m) / 3 + 0.1;
  for (int i = 0; i < 6; ++i) y -= (y * y * y - m) / (3 * y * y);
  const double square = y * y;
  const double beyond = std::fma(y, y, -square);
  y -= (std::fma(square, y, -m) + beyond * y) / (3 * square);
  return std::ldexp(y, exponent / 3);
}

// √(x² + y²) of numbers whose squares are neither too large nor too small.
[[nodiscard]] inline double FindHypotenuse(double x, double y) { return std::sqrt(std::fma(x, x, y * y)); }

}  // namespace wobble::physics
