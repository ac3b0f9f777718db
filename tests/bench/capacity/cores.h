// Chooses a core for each measured thread.
#pragma once

namespace wobble::bench {

struct Cores {
  int server = 0;
  int bots = 0;
};
// The first and the last core that this process may run on: on a machine with at least two cores, these are not two
// hardware threads of one core. With a single core both are the same.
[[nodiscard]] Cores ChooseCores();
// Pins the calling thread, and all threads that it starts later, to this core.
void StayOn(int core);

}  // namespace wobble::bench
