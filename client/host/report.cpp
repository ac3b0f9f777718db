#include "client/host/report.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "client/command/exit_codes.h"
#include "client/host/summary.h"

namespace wobble::host {
namespace {

// Whether the world of these bots died: then those that came back are no failure.
bool HasDied(const std::deque<Part>& parts, std::size_t world) {
  return std::ranges::any_of(parts, [world](const Part& part) {
    return part.role == Part::Role::kWorld && part.world == world && part.keeper.Deaths() > 0;
  });
}

}  // namespace

std::filesystem::path SummaryOf(const Part& part, const std::filesystem::path& folder) {
  return folder / part.summaryFile;
}

unsigned CountRestarts(const std::deque<Part>& parts) {
  unsigned restarts = 0;
  for (const Part& part : parts) restarts += part.keeper.Restarts();
  return restarts;
}

std::string FormatStatus(const std::deque<Part>& parts, double left) {
  std::string world, gateway, bots;
  std::size_t up = 0, worlds = 0;
  for (const Part& part : parts) {
    if (part.isRetired) continue;
    const bool isRunning = part.keeper.ReadState() == Keeper::State::kRunning;
    const bool isWorld = part.role == Part::Role::kWorld;
    worlds += isWorld ? 1 : 0;
    up += isWorld && isRunning ? 1 : 0;
    std::string& line = isWorld ? world : part.role == Part::Role::kGateway ? gateway : bots;
    if (line.empty()) line = isRunning || part.role == Part::Role::kBots ? part.line : part.name + " is down";
  }
  std::string status;
  const auto add = [&status](const std::string& words) {
    if (!words.empty()) status += (status.empty() ? "" : " | ") + words;
  };
  if (std::isfinite(left)) add(std::to_string(std::lround(left)) + " s left");
  for (const std::string& each : {world, gateway, bots}) add(each);
  const unsigned restarts = CountRestarts(parts);
  if (up < worlds || restarts > 0) add(std::to_string(up) + "/" + std::to_string(worlds) + " worlds up");
  if (restarts > 0) add(CountOf(restarts, "restart"));
  return status;
}

std::vector<std::string> FindFailures(const std::deque<Part>& parts) {
  std::vector<std::string> failures;
  for (const Part& part : parts) {
    const Keeper::State state = part.keeper.ReadState();
    if (part.isRetired) continue;
    if (state == Keeper::State::kGivenUp) {
      failures.push_back("the " + part.name + " ended with exit code " + std::to_string(part.exitCode.value_or(0)) +
                         " and could not be started again");
    } else if ((state == Keeper::State::kWaiting || state == Keeper::State::kStarting) && part.keeper.Deaths() > 0) {
      failures.push_back("the " + part.name + " had died and was not back at the end");
    }
  }
  return failures;
}

int Report(const std::deque<Part>& parts, const std::filesystem::path& folder, bool isEarly, double now,
           std::vector<std::string> failures) {
  for (const Part& part : parts) {
    const bool isExpected = part.exitCode == 0 && part.keeper.HasBeenReady();
    const std::filesystem::path file = SummaryOf(part, folder);
    if (part.role == Part::Role::kGateway && !part.line.empty()) {
      std::printf("gateway: %s\n", part.line.c_str());  // its last is what it counted
    } else if (part.role == Part::Role::kWorld && part.child) {
      ReportServer(part.name, file, isExpected, failures);
    } else if (part.role == Part::Role::kBots && part.child) {
      const BotsRun run{.isExpected = isExpected, .wasCutOff = HasDied(parts, part.world), .isEarly = isEarly};
      ReportBots(part.name, file, run, failures);
    }
    if (part.keeper.Restarts() == 0) continue;
    std::printf("%s: %s, %.1f s down; the figures are those since\n", part.name.c_str(),
                CountOf(part.keeper.Restarts(), "restart").c_str(), part.keeper.SecondsDown(now));
  }
  for (const std::string& failure : failures) std::printf("FAILED: %s\n", failure.c_str());
  const unsigned restarts = CountRestarts(parts);
  if (failures.empty() && restarts == 0) std::printf("all went well\n");
  if (failures.empty() && restarts > 0) {
    std::printf("all went well in the end: what had died came back (%s)\n", CountOf(restarts, "restart").c_str());
  }
  std::fflush(stdout);
  return failures.empty() ? command::kExitGood : command::kExitFailed;
}

}  // namespace wobble::host
