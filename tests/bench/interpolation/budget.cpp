#include "tests/bench/interpolation/experiments.h"

namespace wobble::bench {

void MeasureBudget(Bench&) {}

}  // namespace wobble::bench
