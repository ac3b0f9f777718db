// The experiment of `wobble_lab capacity`.
#pragma once

#include "tests/bench/report.h"

namespace wobble::bench {

// Keys players_at_60hz, tick_ms_*, overrun_share, kbit_per_client, and what else there is to say of that count.
void MeasurePlayers(Bench& bench);

}  // namespace wobble::bench
