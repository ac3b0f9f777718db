// Compiled for AVX-512; runs only on processors that have it.
#include "tests/bench/throughput/peak.h"
#include "tests/bench/throughput/peak_kernel.h"

namespace wobble::bench {

float RunChainsAvx512() { return RunChains<16>(); }

}  // namespace wobble::bench
