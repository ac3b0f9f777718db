// `wobble_lab throughput`: what steps and ticks cost, beside plain code, beside Bullet and beside what the core could
// do at most, all in the same run: these machines are shared, and what holds on all of them are ratios.
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
