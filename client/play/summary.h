// What the children measured, from the files that they wrote at their end.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace wobble::play {

// A line each on standard output, and what is wrong by these figures added to `failures`. A file that is missing or
// broken is a failure when isExpected: its writer ended well.
void ReportServer(const std::string& name, const std::filesystem::path& file, bool isExpected,
                  std::vector<std::string>& failures);
void ReportBots(const std::string& name, const std::filesystem::path& file, bool isExpected,
                std::vector<std::string>& failures);

}  // namespace wobble::play
