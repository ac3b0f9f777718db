#include "tests/bench/capacity/cores.h"

#include <pthread.h>
#include <sched.h>

namespace wobble::bench {

Cores ChooseCores() {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  if (sched_getaffinity(0, sizeof allowed, &allowed) != 0) return {};
  Cores cores{-1, -1};
  for (int core = 0; core < CPU_SETSIZE; ++core) {
    if (!CPU_ISSET(core, &allowed)) continue;
    if (cores.server < 0) cores.server = core;
    cores.bots = core;
  }
  return cores;
}

void StayOn(int core) {
  cpu_set_t only;
  CPU_ZERO(&only);
  CPU_SET(core, &only);
  // Cannot fail: the process may run on that core
  static_cast<void>(pthread_setaffinity_np(pthread_self(), sizeof only, &only));
}

}  // namespace wobble::bench
