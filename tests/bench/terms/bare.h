// The sweep of eight lanes as it would be if it knew springs, masses and, if it is said, gas, and nothing else: what
// can be switched off is not in it.
#pragma once

#include "server/physics/lanes/sweep.h"

namespace wobble::bench {

[[nodiscard]] physics::SweepKernel<float> MakeBareKernel(bool hasGas);

}  // namespace wobble::bench
