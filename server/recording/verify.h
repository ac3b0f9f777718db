// Proves that a recording plays the same again.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "server/recording/replay.h"

namespace wobble::recording {

enum class Verdict { kIdentical, kDifferent, kBrokenOff, kUnreadable };

struct Proof {
  Verdict verdict = Verdict::kIdentical;
  std::string words;             // a line, or two if the file is damaged behind what was played
  std::uint64_t wholeState = 0;  // hash of all that the next tick would depend on, contacts' memory included
};

// Called after each second that is played, with its time and that of the end, s. False: stop; unless it has found a
// difference already, the proof is broken off.
using Progress = std::function<bool(double time, double end)>;

// Plays the file as fast as it goes and compares the trace of every tick and the state at every keyframe.
[[nodiscard]] Proof Verify(const std::filesystem::path& path, const GroundSettings& settings, const Progress& progress);

}  // namespace wobble::recording
