// A core for each thread that is measured.
#pragma once

namespace wobble::bench {

struct Cores {
  int server = 0;
  int bots = 0;
};
// The first and the last core that this process may run on, which are threads of one and the same core on no machine
// that has two; the same twice where there is only one.
[[nodiscard]] Cores ChooseCores();
// Keeps the calling thread, and all that it starts, to this core.
void StayOn(int core);

}  // namespace wobble::bench
