#include "tests/bench/stability/experiments.h"

namespace wobble::bench {

void MeasurePerturbations(Bench&) {}

}  // namespace wobble::bench
