#include "tests/bench/accuracy/experiments.h"

namespace wobble::bench {

void MeasureScenes(Bench&) {}

}  // namespace wobble::bench
