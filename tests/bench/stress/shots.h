// Bodies of every kind shot at what should hold them, faster than they can bear; a number reproduces a shot.
#pragma once

#include "tests/bench/stress/bodies.h"

namespace wobble::bench {

enum class StressTarget : std::uint8_t { kFloor, kWall, kTerrain, kBody, kSheet };
inline constexpr StressTarget kAllStressTargets[] = {StressTarget::kFloor, StressTarget::kWall, StressTarget::kTerrain,
                                                     StressTarget::kBody, StressTarget::kSheet};
[[nodiscard]] const char* NameStressTarget(StressTarget target);

struct StressShot {
  StressTarget target = StressTarget::kFloor;
  StressBody body = StressBody::kBall162;
  StressBody other = StressBody::kBall162;  // the target, where it is a body
  double speed = 0;                         // relative to the target, m/s
  double behind = 0;                        // share of the vertices on the wrong side at the end
  // The middle is behind at the end, or half of the vertices. Of bodies: they have changed sides through
  // one another.
  bool through = false;
  bool hangs = false;  // some vertices are behind, the body is not
  StressOutcome outcome;
};

// Speeds of 5 to 100 m/s.
[[nodiscard]] StressShot PlayStressShot(std::uint64_t seed, std::size_t number);

}  // namespace wobble::bench
