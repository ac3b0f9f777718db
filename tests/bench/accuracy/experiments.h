// The experiments of `wobble_lab accuracy`.
#pragma once

#include "tests/bench/report.h"

namespace wobble::bench {

// Key reference_agreement: the engine in fine steps against the reference, over all problems.
void MeasureReference(Bench& bench);
// Keys exact_*: engine and reference against solutions in closed form.
void MeasureExactSolutions(Bench& bench);
// Keys order_*: how the error of each method falls with its step.
void MeasureOrders(Bench& bench);
// No key: rows and plots of run time, evaluations of the forces and error of each method, Boost.odeint's beside them.
void MeasureWorkAndPrecision(Bench& bench);
// No key: what each method does to the energy of a body that loses none.
void MeasureEnergies(Bench& bench);
// Key speedup_vs_odeint.
void MeasureOpponents(Bench& bench);
// Keys error_target_met, error_target_overhead: bodies stepped as the server steps them.
void MeasureErrorTargets(Bench& bench);
// Scenes as the server plays them, with what a second of them costs.
void MeasureScenes(Bench& bench);

}  // namespace wobble::bench
