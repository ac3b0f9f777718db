// `wobble_lab stability`: the largest stable step of each method against theory, the decay of a perturbation, and
// thousands of random worlds in the server's own stepping, none of which may fail.
#include "tests/bench/stability/experiments.h"
#include "tests/bench/stress/experiments.h"

namespace wobble::bench {

void ReportStability(Bench& bench) {
  constexpr Part kParts[] = {
      // shares: minutes of a full run
      {"limits", 3, &MeasureLimits},
      {"perturbations", 1, &MeasurePerturbations},
      {"growth", 1, &MeasureGrowth},
      {"broken states", 13, &MeasureBrokenStates},
      {"stress", 4, &MeasureStress},
      {"stacks", 15, &MeasureStressStacks},
      {"cloth pile", 60, &MeasureClothPile},
      {.name = "random trials", .share = 35, .measure = &MeasureRandomTrials, .hasTrials = true},
  };
  MeasureParts(bench, kParts);
}

}  // namespace wobble::bench
