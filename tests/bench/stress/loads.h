// Loads that no body is made to bear. Each is a trial of its own: a world, a load, two seconds without it.
#pragma once

#include "tests/bench/stress/bodies.h"

namespace wobble::bench {

enum class StressLoad : std::uint8_t {
  kCrush,    // a plate of 10 to 100 times the body's mass falls on it and stays for two seconds
  kSpin,     // turned so fast that its rim moves at 10 to 60 m/s
  kStretch,  // five times as long along any axis, or in all directions, and let go
  kMasses,   // a body of a thousand times the mass falls on it
  kBag,      // 64 in a bag of cloth
  kCut,      // cut through ten times while a plate, or on a sheet a ball, presses
};
inline constexpr StressLoad kAllStressLoads[] = {StressLoad::kCrush,  StressLoad::kSpin, StressLoad::kStretch,
                                                 StressLoad::kMasses, StressLoad::kBag,  StressLoad::kCut};
[[nodiscard]] const char* NameStressLoad(StressLoad load);

// Whether the load makes sense for such a body: what holds gas cannot be cut, nor has a pair a middle.
[[nodiscard]] bool IsLoadFor(StressLoad load, StressBody kind);

// Whether a quick run has time for it: bags only of the bodies that step fastest.
[[nodiscard]] bool IsQuick(StressLoad load, StressBody kind);

// quick: a bag of 8.
[[nodiscard]] StressOutcome PlayLoad(StressLoad load, StressBody kind, std::uint64_t seed, bool quick);

}  // namespace wobble::bench
