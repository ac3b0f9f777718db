// The clock of the commands of `wobble`; the code below them takes the time as a parameter.
#pragma once

#include <chrono>

namespace wobble::command {

// Seconds since some fixed moment, never backwards.
[[nodiscard]] inline double ReadClock() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace wobble::command
