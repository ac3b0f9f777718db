// The experiments of `wobble_lab stability`.
#pragma once

#include "tests/bench/report.h"

namespace wobble::bench {

// Keys theory_deviation_max, server_step_over_limit_max: the largest stable step of each method over stiffness, damping
// and gas.
void MeasureLimits(Bench& bench);
// Key perturbation_rk4_left and a plot: a body is deformed by an external force and released.
void MeasurePerturbations(Bench& bench);
// Key growth_over_bound_max and a plot: how fast two motions that begin side by side diverge.
void MeasureGrowth(Bench& bench);
// Keys random_trials, non_finite, inverted_after_2s, reset, quarantined, penetration_p999: random worlds in the
// server's own stepping.
void MeasureRandomTrials(Bench& bench);
// Key recovered_share: bodies in states that no motion can have brought, two seconds later.
void MeasureBrokenStates(Bench& bench);

}  // namespace wobble::bench
