// Measures the peak of the core: fused multiply-adds in registers and nothing else. A time measured beside it tells how
// much of the machine was used, whatever its clock rate was then.
#pragma once

#include "tests/bench/thread_time.h"

namespace wobble::bench {

// In float, with the widest vectors that the engine uses on this processor.
class Peak {
 public:
  // Takes 0.1 ms; call it between the repetitions of a measurement.
  void Measure();
  [[nodiscard]] double FlopsPerSecond() const;

 private:
  Fastest m_time;
};

// Whether the engine steps 16 bodies at a time; limits on times depend on it.
[[nodiscard]] bool HasAvx512();

// Each is compiled for its own instruction set. Returns the last state of the chains, so that the compiler cannot
// remove them.
[[nodiscard]] float RunChainsAvx2();
[[nodiscard]] float RunChainsAvx512();

}  // namespace wobble::bench
