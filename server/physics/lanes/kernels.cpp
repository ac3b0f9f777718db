// Asks the processor once. Each kernel is compiled in a translation unit of its own for its instruction set; this one
// is compiled for the baseline.
#include "server/physics/lanes/kernels.h"

#include <algorithm>
#include <array>

namespace wobble::physics {

template <class Real>
std::span<const SweepKernel<Real>> FindSweepKernels(int widest) {
  // AVX2 is the baseline of the whole program. MakeAvx512Kernel itself is compiled for AVX-512, so it is called only
  // where that runs.
  static const std::size_t known =
      __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512dq") != 0 ? 3 : 2;
  static const std::array<SweepKernel<Real>, 3> kernels{MakeOneLaneKernel(Real()), MakeAvx2Kernel(Real()),
                                                        known == 3 ? MakeAvx512Kernel(Real()) : SweepKernel<Real>{}};
  const auto isTooWide = [widest](const SweepKernel<Real>& kernel) { return kernel.width > std::max(1, widest); };
  const auto end = std::find_if(kernels.begin(), kernels.begin() + known, isTooWide);
  return {kernels.begin(), end};
}

template std::span<const SweepKernel<float>> FindSweepKernels<float>(int);
template std::span<const SweepKernel<double>> FindSweepKernels<double>(int);

}  // namespace wobble::physics
