// `wobble_lab throughput`: what steps and ticks cost, beside plain code, beside Bullet and beside what the core could do
// at most, all in the same run: these machines are shared, and what counts are ratios.
#include "tests/bench/throughput/experiments.h"

namespace wobble::bench {

void ReportThroughput(Bench& bench) {
  constexpr Part kParts[] = {
//      {"vertex steps", 0.1, &MeasureVertexSteps},
      {"b", 0.1, &MeasureBulletApart},
      {"c", 0.1, &MeasureBulletTouching},
  };
  MeasureParts(bench, kParts);
}

}  // namespace wobble::bench
