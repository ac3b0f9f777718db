// `wobble_lab contact`: contact as the server plays it, against theory where it exists, otherwise against the same
// equations solved in converged steps.
#include "tests/bench/contact/experiments.h"
#include "tests/bench/intersections/experiments.h"

namespace wobble::bench {

void ReportContact(Bench& bench) {
  constexpr Part kParts[] = {
      {"bounces", 0.15, &MeasureBounces},
      {"laws", 0.01, &MeasureLaws},
      {"slides", 0.14, &MeasureSlides},
      {"collisions", 0.08, &MeasureCollisions},
      {"stacks", 0.02, &MeasureStacks},
      {"apart", 0.02, &MeasureApart},
      {"intersections", 0.2, &MeasureIntersections},
      {.name = "shots", .share = 0.58, .measure = &MeasureShots, .hasTrials = true},
  };
  MeasureParts(bench, kParts);
}

}  // namespace wobble::bench
