#include "tests/bench/accuracy/experiments.h"

namespace wobble::bench {

void MeasureReference(Bench&) {}

}  // namespace wobble::bench
