// The sweep of eight lanes with springs, masses and optionally gas only: everything that can be switched off is
// removed.
#pragma once

#include "server/physics/kernels/sweep.h"

namespace wobble::bench {

[[nodiscard]] physics::SweepKernel<float> MakeBareKernel(bool hasGas);

}  // namespace wobble::bench
