// The kernels of one lane and of AVX2, the program's baseline.
#include "server/physics/lanes/kernels.h"
#include "server/physics/lanes/lone_kernel.h"
#include "server/physics/lanes/sweep_kernel.h"

namespace wobble::physics {

SweepKernel<float> MakeAvx2Kernel(float) { return MakeKernel<float, 8>(); }
SweepKernel<double> MakeAvx2Kernel(double) { return MakeKernel<double, 4>(); }
SweepKernel<float> MakeOneLaneKernel(float) { return MakeLoneKernel<float>(); }
SweepKernel<double> MakeOneLaneKernel(double) { return MakeLoneKernel<double>(); }
ElementStrain<float> FindElementStrain(const SweepTables<float>& tables, const float* positions) {
  return FindStrain(tables, positions);
}
ElementStrain<double> FindElementStrain(const SweepTables<double>& tables, const double* positions) {
  return FindStrain(tables, positions);
}

}  // namespace wobble::physics
