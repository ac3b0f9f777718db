// Asks the processor once. Each instruction set has a translation unit of its own; this one is compiled for the
// baseline.
#include "protocol/codec/encoding/crowd_kernels.h"

#include <vector>

#include "protocol/codec/encoding/rounding.h"

namespace wobble::protocol {

CrowdKernels MakeCrowdKernels256();
CrowdKernels MakeCrowdKernels512();
CrowdKernels MakeCrowdKernelsVnni();

const CrowdKernels& FindCrowdKernels(KernelSet most) {
  static const bool hasWide = __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
                              __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512vl") != 0;
  static const bool hasVnni = hasWide && __builtin_cpu_supports("avx512vnni") != 0;
  static const CrowdKernels narrow = MakeCrowdKernels256();
  static const CrowdKernels wide = hasWide ? MakeCrowdKernels512() : narrow;
  static const CrowdKernels vnni = hasVnni ? MakeCrowdKernelsVnni() : wide;
  return most == KernelSet::kVnni ? vnni : most == KernelSet::kAvx512 ? wide : narrow;
}

const float* FindCostsByPlace() {
  static const std::vector<float> costs = [] {
    std::vector<float> all;
    for (std::size_t place = 0; place < kPlaces; ++place) {
      const auto& row = FindCosts()[place / 3];
      all.insert(all.end(), row.begin(), row.end());
    }
    return all;
  }();
  return costs.data();
}

}  // namespace wobble::protocol
