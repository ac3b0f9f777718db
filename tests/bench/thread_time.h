// The clock for what is compared on machines that have other things to do.
#pragma once

#include <time.h>

namespace wobble::bench {

// That this thread has worked, s: what others take from it is not its own.
inline double ReadThreadTime() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

}  // namespace wobble::bench
