// `wobble_lab interpolation`: how far what a player sees is from what was on the server at that moment, through the
// whole path: encoder, a link that loses and delays, clock, jitter buffer and curve of the client library.
#include "tests/bench/interpolation/experiments.h"

namespace wobble::bench {

void ReportInterpolation(Bench& bench) {
  constexpr Part kParts[] = {
      {"links", 0.8, &MeasureLinks},
      {"budget", 0.2, &MeasureBudget},
  };
  MeasureParts(bench, kParts);
}

}  // namespace wobble::bench
