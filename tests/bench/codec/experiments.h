// The experiments of `wobble_lab codec`.
#pragma once

#include "tests/bench/report.h"

namespace wobble::bench {

// Keys speed_median, deformation_median, bits_per_vertex_*, ratio_vs_*, vertex_error_p999_025.
void MeasureCurves(Bench& bench);
// Keys cloth_bits_per_vertex_025, lattice_bits_per_vertex_025.
void MeasureOtherBodies(Bench& bench);
// Key bits_at_rest, through a server with a client that watches.
void MeasureRest(Bench& bench);
// Keys encode_us_per_body, decode_us_per_body.
void MeasureCodecTimes(Bench& bench);

}  // namespace wobble::bench
