// The experiments of `wobble_lab capacity`.
#pragma once

#include "tests/bench/report.h"

namespace wobble::bench {

// Keys players_at_60hz, tick_ms_*, overrun_share, kbit_per_client and the other figures at that player count.
void MeasurePlayers(Bench& bench);
// What a player at the default budget sees of the nearest of 128. Keys relevant_error, relevant_left_out.
void MeasureRelevance(Bench& bench);
// A tick of 128 by two threads against one. Key two_threads_ratio.
void MeasureThreads(Bench& bench);

}  // namespace wobble::bench
