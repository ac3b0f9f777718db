// Random trials as recordings.
#pragma once

#include <filesystem>
#include <string>

#include "tests/bench/stability/random_world.h"

namespace wobble::bench {

struct TrialRecording {
  std::filesystem::path file;  // empty: there is none
  std::string fault;           // why there is none, or where it is not the trial to the bit; empty: nothing
};

// Plays the trial once more, for so many ticks, and records it into the folder, which is made if it is not there. The
// recording holds the bodies as they begin, and every kick, tilt and wish with its tick.
[[nodiscard]] TrialRecording RecordTrial(std::uint64_t seed, std::uint32_t number, int ticks,
                                         const std::filesystem::path& folder);

}  // namespace wobble::bench
