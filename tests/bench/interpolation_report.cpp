// `wobble_lab interpolation`: the distance between what a player sees and the state of the server at that moment,
// through the whole path: encoder, a link with loss and delay, clock, jitter buffer and curve of the client library.
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
