// The experiments of `wobble_lab skip`.
#pragma once

#include "tests/bench/report.h"

namespace wobble::bench {

// Key asleep_ratio: a server's tick with a thousand sleepers against one without them.
void MeasureAsleep(Bench& bench);
// Key apart_ratio: what it takes of a tick to find out that nobody touches anybody.
void MeasureSearch(Bench& bench);
// Key term_ratio_max: instructions of a sweep that could do more against one that cannot.
void MeasureTerms(Bench& bench);
// Key empty_cpu: a server that nobody has joined.
void MeasureEmpty(Bench& bench);

}  // namespace wobble::bench
