#include "tests/bench/stress/rows.h"

#include <algorithm>

namespace wobble::bench {

void Add(const StressOutcome& from, StressOutcome& sum) {
  sum.nonFinite += from.nonFinite;
  sum.quarantined += from.quarantined;
  sum.reset += from.reset;
  sum.inverted += from.inverted;
  sum.folded += from.folded;
  sum.through += from.through;
  sum.substeps = std::max(sum.substeps, from.substeps);
}

nlohmann::ordered_json MakeStressRow(const char* experiment, const char* what, const char* body, double trials,
                                     const StressOutcome& sum) {
  return {{"experiment", experiment},
          {"what", what},
          {"body", body},
          {"trials", trials},
          {"non_finite", sum.nonFinite},
          {"quarantined", sum.quarantined},
          {"reset", sum.reset},
          {"inverted_after_2s", sum.inverted},
          {"folded_lattices", sum.folded},
          {"through", sum.through},
          {"most_substeps", sum.substeps}};
}

}  // namespace wobble::bench
