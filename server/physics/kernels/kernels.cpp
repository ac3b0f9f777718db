// Asks the processor once. Each kernel is compiled in a translation unit of its own for its instruction set; this one
// is compiled for the baseline. The environment's WOBBLE_ISA=avx2 leaves AVX-512 unused, to measure what other
// processors reach; no result depends on it.
#include "server/physics/kernels/kernels.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string_view>

namespace wobble::physics {
namespace {

// MakeAvx512Kernel itself is compiled for AVX-512, so it is called only where that runs.
#ifdef __x86_64__
bool HasAvx512() {
  const char* most = std::getenv("WOBBLE_ISA");
  if (most != nullptr && std::string_view(most) == "avx2") return false;
  return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512dq") != 0;
}
template <class Real>
SweepKernel<Real> MakeWidestKernel() {
  return HasAvx512() ? MakeAvx512Kernel(Real()) : SweepKernel<Real>{};
}
#else
template <class Real>
SweepKernel<Real> MakeWidestKernel() {
  return {};
}
#endif

}  // namespace

template <class Real>
std::span<const SweepKernel<Real>> FindSweepKernels(int widest) {
  static const std::array<SweepKernel<Real>, 3> kernels{MakeOneLaneKernel(Real()), MakeBaselineKernel(Real()),
                                                        MakeWidestKernel<Real>()};
  static const std::size_t known = kernels.back().width > 0 ? 3 : 2;
  const auto isTooWide = [widest](const SweepKernel<Real>& kernel) { return kernel.width > std::max(1, widest); };
  const auto end = std::find_if(kernels.begin(), kernels.begin() + known, isTooWide);
  return {kernels.begin(), end};
}

template std::span<const SweepKernel<float>> FindSweepKernels<float>(int);
template std::span<const SweepKernel<double>> FindSweepKernels<double>(int);

}  // namespace wobble::physics
