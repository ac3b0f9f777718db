// `wobble_lab throughput`: the cost of steps and ticks against plain code, Bullet and the peak of the core, all in the
// same run: the machines are shared, and only ratios hold on all of them.
#include "tests/bench/throughput/experiments.h"

namespace wobble::bench {

void ReportThroughput(Bench& bench) {
  constexpr Part kParts[] = {
      {"vertex steps", 0.2, &MeasureVertexSteps},
      {"ticks", 0.05, &MeasureTicks},
      {"Bullet, apart", 0.05, &MeasureBulletApart},
      {"Bullet, touching", 0.25, &MeasureBulletTouching},
      {"ladder", 0.05, &MeasureLadder},
      {"sizes", 0.1, &MeasureSizes},
      {"crowds", 0.3, &MeasureCrowds},
  };
  MeasureParts(bench, kParts);
}

}  // namespace wobble::bench
