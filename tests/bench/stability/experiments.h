// The experiments of `wobble_lab stability`.
#pragma once

#include "tests/bench/report.h"

namespace wobble::bench {

// Key theory_deviation_max: the largest step that each method bears, over stiffness, damping and gas.
void MeasureLimits(Bench& bench);
// Rows and a plot: a body is pulled out of shape by a force that is none of its own, and let go.
void MeasurePerturbations(Bench& bench);
// Rows and a plot: how fast two motions part that began beside one another.
void MeasureGrowth(Bench& bench);
// Keys random_trials, non_finite, inverted, quarantined, penetration_p999.
void MeasureRandomTrials(Bench& bench);

}  // namespace wobble::bench
