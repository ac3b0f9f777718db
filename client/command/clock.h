// Time as the commands of `wobble` read it; everything below them is given it.
#pragma once

#include <chrono>

namespace wobble::tool {

// Seconds since some fixed moment, never backwards.
[[nodiscard]] inline double ReadClock() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// The longest run that can be asked for, seconds: eleven days.
inline constexpr double kMaxDuration = 1e6;

}  // namespace wobble::tool
