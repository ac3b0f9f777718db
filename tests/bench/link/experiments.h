// The experiments of `wobble_lab link`.
#pragma once

#include "tests/bench/report.h"

namespace wobble::bench {

// Keys LINE_KIND_delay_ms_p50 and _p99, _stalls, _gaps, _join_ms for each emulated line, by the native client over UDP
// and by the page's connection code over TCP.
void MeasureLines(Bench& bench);

}  // namespace wobble::bench
