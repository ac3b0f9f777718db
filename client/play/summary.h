// Reports what the children measured, from the summary files that they wrote at their end.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace wobble::play {

// Print one line on standard output and append to `failures` what these figures show to be wrong. isExpected: the
// writer ended well, so a missing or broken file is a failure.
void ReportServer(const std::string& name, const std::filesystem::path& file, bool isExpected,
                  std::vector<std::string>& failures);
void ReportBots(const std::string& name, const std::filesystem::path& file, bool isExpected,
                std::vector<std::string>& failures);

}  // namespace wobble::play
