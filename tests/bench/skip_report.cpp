// `wobble_lab skip`: the cost of features that are not in use: sleeping bodies, terms that a blueprint lacks,
// neighbours out of reach, a server without players.
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
