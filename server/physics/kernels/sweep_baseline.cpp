// The kernels of one lane and of the vectors that every processor has: AVX2 on x86, NEON on ARM.
#include "server/physics/kernels/kernels.h"
#include "server/physics/kernels/lone_kernel.h"
#include "server/physics/kernels/sweep_kernel.h"

namespace wobble::physics {

SweepKernel<float> MakeBaselineKernel(float) { return MakeKernel<float, kBaselineBytes / sizeof(float)>(); }
SweepKernel<double> MakeBaselineKernel(double) { return MakeKernel<double, kBaselineBytes / sizeof(double)>(); }
SweepKernel<float> MakeOneLaneKernel(float) { return MakeLoneKernel<float>(); }
SweepKernel<double> MakeOneLaneKernel(double) { return MakeLoneKernel<double>(); }
ElementStrain<float> FindElementStrain(const SweepTables<float>& tables, const float* positions) {
  return FindStrain(tables, positions);
}
ElementStrain<double> FindElementStrain(const SweepTables<double>& tables, const double* positions) {
  return FindStrain(tables, positions);
}

}  // namespace wobble::physics
