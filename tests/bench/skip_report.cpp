// `wobble_lab skip`: the cost of features that are not in use: sleeping bodies, terms that a blueprint lacks,
// neighbours out of reach, a server without players; what recording costs; and how soon bodies that look at rest sleep.
#include "tests/bench/skip/experiments.h"

namespace wobble::bench {

void ReportSkip(Bench& bench) {
  constexpr Part kParts[] = {
      {"asleep", 0.4, &MeasureAsleep},     {"search", 0.2, &MeasureSearch},      {"terms", 0.2, &MeasureTerms},
      {"settling", 0.1, &MeasureSettling}, {"nobody there", 0.1, &MeasureEmpty}, {"recording", 0.5, &MeasureRecording},
  };
  MeasureParts(bench, kParts);
}

}  // namespace wobble::bench
