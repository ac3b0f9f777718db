// `wobble_lab stability`: the largest stable step of each method against theory, the decay of a perturbation, and
// thousands of random worlds in the server's own stepping, none of which may fail.
#include "tests/bench/stability/experiments.h"

namespace wobble::bench {

void ReportStability(Bench& bench) {
  constexpr Part kParts[] = {
      {"limits", 0.05, &MeasureLimits},
      {"perturbations", 0.02, &MeasurePerturbations},
      {"growth", 0.03, &MeasureGrowth},
      {"broken states", 0.1, &MeasureBrokenStates},
      {"stress", 0.1, &MeasureStress},
      {.name = "random trials", .share = 0.7, .measure = &MeasureRandomTrials, .hasTrials = true},
  };
  MeasureParts(bench, kParts);
}

}  // namespace wobble::bench
