// The kernels of AVX-512. Compiled for it and run only on processors that have it.
#include "server/physics/kernels/kernels.h"
#include "server/physics/kernels/sweep_kernel.h"

namespace wobble::physics {

SweepKernel<float> MakeAvx512Kernel(float) { return MakeKernel<float, 16>(); }
SweepKernel<double> MakeAvx512Kernel(double) { return MakeKernel<double, 8>(); }

}  // namespace wobble::physics
