// `wobble_lab link`: what players see over real networks, by UDP and by the browser's TCP: this system's own network
// stack between two namespaces, with delay, loss, black-outs and a shared bottleneck between them.
#include "tests/bench/link/experiments.h"

namespace wobble::bench {

void ReportLink(Bench& bench) {
  constexpr Part kParts[] = {{"lines", 1, &MeasureLines}};
  MeasureParts(bench, kParts);
}

}  // namespace wobble::bench
