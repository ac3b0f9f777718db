#include "tests/bench/stability/experiments.h"

namespace wobble::bench {

void MeasureRandomTrials(Bench&) {}

}  // namespace wobble::bench
