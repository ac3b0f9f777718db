// The experiments of `wobble_lab skip`.
#pragma once

#include "tests/bench/report.h"

namespace wobble::bench {

// Key asleep_ratio: a tick of a server with a thousand sleeping bodies over one without them.
void MeasureAsleep(Bench& bench);
// Key apart_ratio: share of a tick that the search takes to find that no bodies touch.
void MeasureSearch(Bench& bench);
// Key term_ratio_max: instructions of a sweep that supports more terms over those of a sweep that does not.
void MeasureTerms(Bench& bench);
// Key empty_cpu: processor share of a server without players.
void MeasureEmpty(Bench& bench);

// Keys recording_core_share, recording_tick_ms_p99, recording_mb_per_hour, seek_ms_p99: a recording of 64 players.
void MeasureRecording(Bench& bench);

// Key settle_s: how long bodies that look at rest stay awake in shipped scenes.
void MeasureSettling(Bench& bench);

}  // namespace wobble::bench
