// Quantities that theory gives in closed form, with the values that the engine and the reference compute.
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
  double scale = 1;  // errors are reported as a share of it; in the unit of the quantity
};

// Motions: oscillators, a spinning pair in free fall, a bouncing particle.
[[nodiscard]] std::vector<ExactValue> SolveExactMotions();
// Equilibria: a hanging chain, shells under gas pressure, a bar under tension.
[[nodiscard]] std::vector<ExactValue> SolveExactEquilibria();

// Young's modulus of a lattice bar under small tension, Pa; `exact` is the modulus in the bar's definition.
[[nodiscard]] ExactValue MeasureYoungModulus();

}  // namespace wobble::bench
