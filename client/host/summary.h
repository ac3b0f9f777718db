// Reports what the children measured, from the summary files that they wrote at their end.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace wobble::host {

// "1 restart", "2 restarts".
[[nodiscard]] std::string CountOf(unsigned count, const std::string& what);

// Prints one line on standard output and appends to `failures` what these figures show to be wrong. isExpected: the
// writer ended well, so a missing or broken file is a failure.
void ReportServer(const std::string& name, const std::filesystem::path& file, bool isExpected,
                  std::vector<std::string>& failures);

// What the figures of bots cannot show.
struct BotsRun {
  bool isExpected = true;  // as for ReportServer
  bool wasCutOff = false;  // their server died: those that came back are no failure
  bool isEarly = false;    // they had no time to join
};
// As ReportServer.
void ReportBots(const std::string& name, const std::filesystem::path& file, const BotsRun& run,
                std::vector<std::string>& failures);

}  // namespace wobble::host
