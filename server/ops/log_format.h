// How the lines of the log look: for people, or one JSON object a line for programs that collect logs.
#pragma once

#include <spdlog/formatter.h>

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

namespace wobble::ops {

enum class LogFormat : std::uint8_t { kText, kJson };

// "text" or "json"; nullopt for any other word.
[[nodiscard]] std::optional<LogFormat> ParseLogFormat(const std::string& word);

// kText: `2026-11-25 08:10:06.123 info MESSAGE`, local time, the level in colour on a terminal.
// kJson: `{"time":"2026-11-25T08:10:06.123Z","level":"info","message":"MESSAGE"}`, UTC. Whatever a message holds, the
// line is one valid object: quotes, backslashes and control characters are escaped, bytes that are no UTF-8 become
// U+FFFD.
[[nodiscard]] std::unique_ptr<spdlog::formatter> MakeLogFormatter(LogFormat format);

}  // namespace wobble::ops
