// Durations as people write them, the same on every command line and in every file.
#pragma once

#include <optional>
#include <string>

namespace wobble::usage {

// The longest duration that an option takes, seconds: eleven days.
inline constexpr double kMaxDuration = 1e6;

// Reads a number with the suffix ms, s, m or h, or without one for seconds, of 0 to kMaxDuration. Returns seconds; on
// failure nullopt, with one line in `error` that names the text and what may be written.
[[nodiscard]] std::optional<double> ParseDuration(const std::string& text, std::string& error);

}  // namespace wobble::usage
