#include "tests/bench/accuracy/experiments.h"

namespace wobble::bench {

void MeasureOrders(Bench&) {}

}  // namespace wobble::bench
