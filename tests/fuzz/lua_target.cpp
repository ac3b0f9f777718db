// Any text as a script of bots: it ends, soon, whatever it calls. Instructions are counted, and what C functions do is
// charged by a model (lua_costs.h); a call that the model takes for cheap and that is not shows here as a time.
#include <ctime>
#include <string>

#include "client/bots/script.h"
#include "tests/fuzz/fuzz_target.h"

namespace wobble::fuzz {
namespace {

constexpr double kMostSeconds = 1;  // of a processor with sanitizers; an honest budget is gone in 20 ms
constexpr int kRounds = 3;

double ReadProcessorTime() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void FuzzOne(const std::string& text) {
  const double begin = ReadProcessorTime();
  bots::Script script(1, [](unsigned, std::string_view) {});
  std::string error;
  if (script.Load(text, "fuzz", error)) {
    const unsigned bot = script.AddBot(error);
    for (int i = 0; bot != 0 && i < kRounds; ++i) {
      bots::Script::Wish wish;
      bots::Script::View view;
      view.time = i / 60.0;
      view.isPlaying = true;
      static_cast<void>(script.Resume(bot, view, wish, error));
    }
  }
  Require(ReadProcessorTime() - begin < kMostSeconds);
}

}  // namespace
}  // namespace wobble::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  wobble::fuzz::FuzzOne(std::string(reinterpret_cast<const char*>(data), size));
  return 0;
}
