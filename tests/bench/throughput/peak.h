// What the core could do at most: fused multiply-adds in registers and nothing else. Beside it a time says how much of
// the machine was used, whatever clock it ran at just then.
#pragma once

#include "tests/bench/thread_time.h"

namespace wobble::bench {

// In float, with the widest vectors that bodies are stepped in.
class Peak {
 public:
  // A tenth of a millisecond, to be called between the repetitions of what is measured.
  void Measure();
  [[nodiscard]] double FlopsPerSecond() const;

 private:
  Fastest m_time;
};

// Whether bodies are stepped 16 at a time: limits on times depend on it.
[[nodiscard]] bool HasAvx512();

// Each compiled for its own instruction set; the last state of the chains, so that they cannot be left out.
[[nodiscard]] float RunChainsAvx2();
[[nodiscard]] float RunChainsAvx512();

}  // namespace wobble::bench
