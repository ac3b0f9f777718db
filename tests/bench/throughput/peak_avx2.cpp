#include "tests/bench/throughput/peak.h"
#include "tests/bench/throughput/peak_kernel.h"

namespace wobble::bench {

float RunChainsAvx2() { return RunChains<8>(); }

}  // namespace wobble::bench
