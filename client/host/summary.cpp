#include "client/host/summary.h"

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

namespace wobble::host {
namespace {

// An empty object when there is none.
nlohmann::json ReadSummary(const std::filesystem::path& file, bool isExpected, std::vector<std::string>& failures) {
  std::ifstream stream(file);
  nlohmann::json summary = nlohmann::json::parse(stream, nullptr, false);
  if (summary.is_object()) return summary;
  if (isExpected) failures.push_back(file.filename().string() + ", the summary, is missing or broken");
  return nlohmann::json::object();
}

// A figure as text, "?" when it is missing or null.
std::string Show(const nlohmann::json& summary, const char* key, int decimals = 0) {
  const auto figure = summary.find(key);
  if (figure == summary.end() || !figure->is_number()) return "?";
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", decimals, figure->get<double>());
  return text;
}

double Number(const nlohmann::json& summary, const char* key) {
  const auto figure = summary.find(key);
  return figure != summary.end() && figure->is_number() ? figure->get<double>() : 0;
}

}  // namespace

std::string CountOf(unsigned count, const std::string& what) {
  return std::to_string(count) + " " + what + (count == 1 ? "" : "s");
}

void ReportServer(const std::string& name, const std::filesystem::path& file, bool isExpected,
                  std::vector<std::string>& failures) {
  const nlohmann::json summary = ReadSummary(file, isExpected, failures);
  if (summary.empty()) return;
  std::printf("%s: %s ticks of %s ms (p50), %s ms (p99), %s overruns, %s joins, %s disconnects, %s non-finite\n",
              name.c_str(), Show(summary, "ticks").c_str(), Show(summary, "tick_ms_p50", 2).c_str(),
              Show(summary, "tick_ms_p99", 2).c_str(), Show(summary, "overruns").c_str(),
              Show(summary, "joins").c_str(), Show(summary, "disconnects").c_str(),
              Show(summary, "non_finite").c_str());
  if (Number(summary, "non_finite") > 0) failures.push_back("bodies became non-finite");
  // A warning only: on a busy machine a tick can be late, and the world then runs behind for a moment.
  if (Number(summary, "overruns") > 0)
    std::printf("warning: %s ticks took too long\n", Show(summary, "overruns").c_str());
}

void ReportBots(const std::string& name, const std::filesystem::path& file, const BotsRun& run,
                std::vector<std::string>& failures) {
  const nlohmann::json summary = ReadSummary(file, run.isExpected, failures);
  if (summary.empty()) return;
  std::printf("%s: %s of %s connected, %s disconnects, %s script errors, snapshots %s ms old (p50), %s ms (p99)\n",
              name.c_str(), Show(summary, "connected").c_str(), Show(summary, "bots").c_str(),
              Show(summary, "disconnects").c_str(), Show(summary, "script_errors").c_str(),
              Show(summary, "snapshot_age_ms_p50", 1).c_str(), Show(summary, "snapshot_age_ms_p99", 1).c_str());
  if (Number(summary, "connected") < Number(summary, "bots") && !run.isEarly) {
    failures.push_back("not all bots connected");
  }
  const double back = run.wasCutOff ? Number(summary, "rejoins") : 0;
  if (Number(summary, "disconnects") > back) failures.push_back("bots were disconnected");
  if (Number(summary, "script_errors") > 0) failures.push_back("scripts failed");
}

}  // namespace wobble::host
