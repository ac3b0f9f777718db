// The experiments of `wobble_lab accuracy`.
#pragma once

#include "tests/bench/report.h"

namespace wobble::bench {

// Key reference_agreement: the engine in fine steps against the reference, over all problems.
void MeasureReference(Bench& bench);
// Keys exact_*, young_modulus_error: engine and reference against solutions in closed form.
void MeasureExactSolutions(Bench& bench);
// Keys order_*: the order of convergence of each method, from its error over step size.
void MeasureOrders(Bench& bench);
// No key: rows and plots of run time, force evaluations and error of each method, with Boost.odeint for comparison.
void MeasureWorkAndPrecision(Bench& bench);
// No key: the energy drift of each method on a body that conserves energy.
void MeasureEnergies(Bench& bench);
// Key speedup_vs_odeint.
void MeasureOpponents(Bench& bench);
// Keys error_target_met, error_target_overhead: single bodies stepped as the server steps them.
void MeasureErrorTargets(Bench& bench);
// Keys scene_error_*: whole scenes played as the server plays them, with the cost of a second of play.
void MeasureScenes(Bench& bench);

}  // namespace wobble::bench
