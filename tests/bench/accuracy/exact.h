// What theory says in closed form, beside what the engine and the reference make of it.
#pragma once

#include <string>
#include <vector>

namespace wobble::bench {

struct ExactValue {
  std::string problem;
  std::string quantity;  // with its unit
  double exact = 0;
  double engine = 0;
  double reference = 0;
  double scale = 1;  // what an error is a share of, in the same unit
};

// Oscillators, a spinning pair in free fall, a particle that bounces.
[[nodiscard]] std::vector<ExactValue> SolveExactMotions();
// A hanging chain, shells under gas pressure, a bar under tension.
[[nodiscard]] std::vector<ExactValue> SolveExactEquilibria();

// Young's modulus of a lattice bar that is pulled a little, Pa: that of its definition as the exact one.
[[nodiscard]] ExactValue MeasureYoungModulus();

}  // namespace wobble::bench
