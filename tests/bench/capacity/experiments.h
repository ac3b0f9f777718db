// The experiment of `wobble_lab capacity`.
#pragma once

#include "tests/bench/report.h"

namespace wobble::bench {

// Keys players_at_60hz, tick_ms_*, overrun_share, kbit_per_client and the other figures at that player count.
void MeasurePlayers(Bench& bench);

}  // namespace wobble::bench
