#include "tests/bench/accuracy/experiments.h"

namespace wobble::bench {

void MeasureExactSolutions(Bench&) {}

}  // namespace wobble::bench
