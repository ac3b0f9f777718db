// `wobble_lab capacity`: how many players this machine can host, a core for the server and another for the bots, and
// what each of them gets.
#include "tests/bench/capacity/experiments.h"

namespace wobble::bench {

void ReportCapacity(Bench& bench) {
  constexpr Part kParts[] = {{"seconds of play", 1, &MeasurePlayers}};
  MeasureParts(bench, kParts);
}

}  // namespace wobble::bench
