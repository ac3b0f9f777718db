// Asks the processor once. Each instruction set has a translation unit of its own; this one is compiled for the
// baseline. The environment's WOBBLE_ISA=avx2 leaves AVX-512 unused, as in the engine.
#include "protocol/codec/encoding/crowd_kernels.h"

#include <cstdlib>
#include <string_view>
#include <vector>

#include "protocol/codec/encoding/rounding.h"

namespace wobble::protocol {

CrowdKernels MakeNarrowCrowdKernels();

#ifdef __x86_64__

namespace {

bool HasWide() {
  const char* most = std::getenv("WOBBLE_ISA");
  if (most != nullptr && std::string_view(most) == "avx2") return false;
  return __builtin_cpu_supports("avx512f") != 0 && __builtin_cpu_supports("avx512bw") != 0 &&
         __builtin_cpu_supports("avx512dq") != 0 && __builtin_cpu_supports("avx512vl") != 0;
}

}  // namespace

CrowdKernels MakeCrowdKernels512();
CrowdKernels MakeCrowdKernelsVnni();

const CrowdKernels& FindCrowdKernels(KernelSet most) {
  static const bool hasWide = HasWide();
  static const bool hasVnni = hasWide && __builtin_cpu_supports("avx512vnni") != 0;
  static const CrowdKernels narrow = MakeNarrowCrowdKernels();
  static const CrowdKernels wide = hasWide ? MakeCrowdKernels512() : narrow;
  static const CrowdKernels vnni = hasVnni ? MakeCrowdKernelsVnni() : wide;
  return most == KernelSet::kVnni ? vnni : most == KernelSet::kAvx512 ? wide : narrow;
}

#else

const CrowdKernels& FindCrowdKernels(KernelSet) {
  static const CrowdKernels narrow = MakeNarrowCrowdKernels();
  return narrow;
}

#endif

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
