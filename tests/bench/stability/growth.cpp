#include "tests/bench/stability/experiments.h"

namespace wobble::bench {

void MeasureGrowth(Bench&) {}

}  // namespace wobble::bench
