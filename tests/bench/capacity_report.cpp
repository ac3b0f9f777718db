// `wobble_lab capacity`: how many players this machine can host with one core for the server and one for the bots, and
// what each player gets.
#include <spdlog/spdlog.h>

#include "tests/bench/capacity/experiments.h"

namespace wobble::bench {

void ReportCapacity(Bench& bench) {
  spdlog::set_level(spdlog::level::off);
  constexpr Part kParts[] = {
      {"seconds of play", 0.8, &MeasurePlayers},
      {"what a player sees", 0.1, &MeasureRelevance},
      {"two threads", 0.1, &MeasureThreads},
  };
  MeasureParts(bench, kParts);
}

}  // namespace wobble::bench
