// A part of a recording as a recording of its own.
#pragma once

#include <filesystem>
#include <string>

#include "server/recording/replay.h"

namespace wobble::recording {

// Writes the seconds of `from` that have ticks behind `begin` and up to `end` into a file of its own, which begins with
// a keyframe. Plays the recording from the keyframe before. Returns what is wrong, in a line; empty: nothing.
[[nodiscard]] std::string WriteExcerpt(const std::filesystem::path& from, std::uint32_t begin, std::uint32_t end,
                                       const std::filesystem::path& to, const GroundSettings& settings);

}  // namespace wobble::recording
