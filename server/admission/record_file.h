// A file of lines that the server changes while it runs: bans, invites.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace wobble::admission {

// The lines without comments (#) and empty ones; a file that is not there has none. False with one line in `error` when
// it cannot be read or has more than a megabyte.
[[nodiscard]] bool ReadLines(const std::filesystem::path& file, std::vector<std::string>& lines, std::string& error);

// Replaces the file at once, so that a server that is killed leaves the old one or the new one; for its owner alone.
[[nodiscard]] bool WriteLines(const std::filesystem::path& file, const std::string& comment,
                              const std::vector<std::string>& lines, std::string& error);

}  // namespace wobble::admission
