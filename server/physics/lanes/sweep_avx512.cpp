// Compiled for AVX-512, run only where the processor has it.
#include "server/physics/lanes/kernels.h"
#include "server/physics/lanes/sweep_kernel.h"

namespace wobble::physics {

SweepKernel<float> MakeAvx512Kernel(float) { return MakeKernel<float, 16>(); }
SweepKernel<double> MakeAvx512Kernel(double) { return MakeKernel<double, 8>(); }

}  // namespace wobble::physics
