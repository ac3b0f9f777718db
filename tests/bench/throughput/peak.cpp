#include "tests/bench/throughput/peak.h"

#include "server/physics/kernels/kernels.h"
#include "tests/bench/throughput/peak_kernel.h"

namespace wobble::bench {

void Peak::Measure() {
  static volatile float sum = 0;  // keeps the compiler from removing the computation
  m_time.Time([] { sum = sum + (HasAvx512() ? RunChainsAvx512() : RunChainsAvx2()); });
}

double Peak::FlopsPerSecond() const {
  constexpr double kFlops = 2;  // of a fused multiply-add
  return kFlops * kChains * kLinks * (HasAvx512() ? 16 : 8) / m_time.Read();
}

bool HasAvx512() { return physics::FindSweepKernels<float>(physics::kWidestPack).back().width == physics::kWidestPack; }

}  // namespace wobble::bench
