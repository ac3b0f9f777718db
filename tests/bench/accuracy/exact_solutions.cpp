// Compares engine and reference with closed forms; that they agree with each other is shown in reference.cpp. The limit
// is the same as for that comparison: the steps are so fine that RK4 is within 1e-10, and equilibria have settled to
// rounding.
//
// Young's modulus has its own limit. The closed form for the bar's length is exact for springs that turn as they
// stretch; the modulus is its limit for small strains, which a bar under 1 % strain only approaches.
#include <algorithm>
#include <cmath>

#include "tests/bench/accuracy/exact.h"
#include "tests/bench/accuracy/experiments.h"
#include "tests/bench/trials.h"

namespace wobble::bench {
namespace {

double FindError(const ExactValue& value, double found) { return std::fabs(found - value.exact) / value.scale; }

void AddExactRow(Bench& bench, const ExactValue& value) {
  bench.results.rows.push_back({{"experiment", "exact solution"},
                                {"problem", value.problem},
                                {"quantity", value.quantity},
                                {"exact", value.exact},
                                {"engine", value.engine},
                                {"reference", value.reference},
                                {"engine_error", FindError(value, value.engine)},
                                {"reference_error", FindError(value, value.reference)}});
}

// NaN counts as worse than any number.
double FindWorst(const ExactValue& value) {
  const double engine = FindError(value, value.engine);
  const double reference = FindError(value, value.reference);
  return std::isfinite(engine) ? std::max(engine, reference) : engine;
}

}  // namespace

void MeasureExactSolutions(Bench& bench) {
  std::vector<ExactValue> motions;
  std::vector<ExactValue> equilibria;
  ExactValue modulus;
  const bool done = RunTrials(bench, 3, [&](std::size_t i) {
    if (i == 0) motions = SolveExactMotions();
    if (i == 1) equilibria = SolveExactEquilibria();
    if (i == 2) modulus = MeasureYoungModulus();
  });
  if (!done) return;
  double worst = 0;
  for (const auto* values : {&motions, &equilibria}) {
    for (const ExactValue& value : *values) {
      AddExactRow(bench, value);
      worst = std::isfinite(worst) ? std::max(worst, FindWorst(value)) : worst;
    }
  }
  AddExactRow(bench, modulus);
  bench.results.AddFigureAtMost("exact_solution_error_max", worst, 1e-9);
  bench.results.AddFigureAtMost("young_modulus_error", FindWorst(modulus), 0.05);
}

}  // namespace wobble::bench
