#include "tests/bench/stability/experiments.h"

namespace wobble::bench {

void MeasureLimits(Bench&) {}

}  // namespace wobble::bench
