// The experiments of `wobble_lab codec`.
#pragma once

#include "tests/bench/report.h"

namespace wobble::bench {

// Keys speed_median, deformation_median, bits_per_vertex_*, ratio_vs_*, vertex_error_p999_025: rate–distortion curves
// of all methods.
void MeasureCurves(Bench& bench);
// Keys cloth_bits_per_vertex_025, lattice_bits_per_vertex_025: our codec on other bodies.
void MeasureOtherBodies(Bench& bench);
// Key bits_at_rest: bodies at rest, measured on a server with a watching client.
void MeasureRest(Bench& bench);
// Keys encode_us_per_body (in crowds of 32 of a blueprint), encode_alone_us_per_body, decode_us_per_body: computing
// time.
void MeasureCodecTimes(Bench& bench);

}  // namespace wobble::bench
