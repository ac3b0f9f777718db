// Proves that a recording plays the same again.
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "server/recording/replay.h"

namespace wobble::recording {

enum class Verdict { kIdentical, kDifferent, kUnreadable };

struct Proof {
  Verdict verdict = Verdict::kIdentical;
  std::string words;  // a line, or two if the file is damaged behind what was played
};

// Plays the file as fast as it goes and compares the trace of every tick and the state at every keyframe.
// progress(tick, first, last): called after each second; false: stop, as far as it went.
[[nodiscard]] Proof Verify(
    const std::filesystem::path& path, const ReplaySettings& settings,
    const std::function<bool(std::uint32_t tick, std::uint32_t first, std::uint32_t last)>& progress);

}  // namespace wobble::recording
