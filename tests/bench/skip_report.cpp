// `wobble_lab skip`: what it costs that a world could do more than it does just now: bodies that sleep, terms that a
// blueprint lacks, neighbours that are too far away, players who are not there.
#include "tests/bench/skip/experiments.h"

namespace wobble::bench {

void ReportSkip(Bench& bench) {
  constexpr Part kParts[] = {
      {"asleep", 0.5, &MeasureAsleep},
      {"search", 0.2, &MeasureSearch},
      {"terms", 0.2, &MeasureTerms},
      {"nobody there", 0.1, &MeasureEmpty},
  };
  MeasureParts(bench, kParts);
}

}  // namespace wobble::bench
