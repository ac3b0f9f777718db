// The experiments of `wobble_lab interpolation`.
#pragma once

#include "tests/bench/report.h"

namespace wobble::bench {

// Keys displayed_error_*, kbit_per_body_30hz*, display_delay_ms*, stalls_share, disconnects, truth_error_of_half: what
// watchers see behind links of different quality.
void MeasureLinks(Bench& bench);
// Keys budget_*: the displayed error split into physics, codec and interpolation.
void MeasureBudget(Bench& bench);

}  // namespace wobble::bench
