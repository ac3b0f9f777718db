#include "tests/bench/report.h"

namespace wobble::bench {

void MeasureParts(Bench& bench, std::span<const Part> parts) {
  for (const Part& part : parts) {
    if (bench.progress.IsStopAsked()) return;
    if (bench.options.trial && !part.hasTrials) continue;
    bench.progress.Begin(part.name, part.share);
    part.measure(bench);
  }
}

}  // namespace wobble::bench
