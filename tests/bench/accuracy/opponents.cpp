#include "tests/bench/accuracy/experiments.h"

namespace wobble::bench {

void MeasureOpponents(Bench&) {}

}  // namespace wobble::bench
