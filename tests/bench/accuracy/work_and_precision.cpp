#include "tests/bench/accuracy/experiments.h"

namespace wobble::bench {

void MeasureWorkAndPrecision(Bench&) {}

}  // namespace wobble::bench
