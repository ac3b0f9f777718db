#include "tests/bench/accuracy/experiments.h"

namespace wobble::bench {

void MeasureErrorTargets(Bench&) {}

}  // namespace wobble::bench
