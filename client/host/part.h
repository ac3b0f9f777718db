// One program of a fleet: its process, what it prints, and its keeper.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/command/child.h"
#include "client/host/keeper.h"

namespace wobble::host {

struct Part {
  enum class Role : std::uint8_t { kWorld, kGateway, kBots };
  Role role = Role::kWorld;
  std::size_t world = 0;    // of kWorld and kBots: its number in the plan
  std::string name;         // in messages
  std::string errorPrefix;  // of its lines on standard error, which are passed on without it
  std::string readyPrefix;  // of the line that it prints when it is ready
  std::string summaryFile;  // name of the file that it leaves its figures in; no other part's

  Keeper keeper = Keeper();
  std::unique_ptr<command::Child> child = {};  // the present process, or the last one
  std::string readyLine = {};                  // of `child`; empty until it is ready
  std::string line = {};                       // its latest other line
  std::optional<int> exitCode = {};            // of `child`, once it has ended
  bool isRetired = false;                      // it is not in the plan any more
  bool wasLate = false;                        // `child` was killed because it was not ready in time

  [[nodiscard]] bool IsOver() const {
    return keeper.ReadState() == Keeper::State::kGivenUp || keeper.ReadState() == Keeper::State::kEnded;
  }
  [[nodiscard]] bool HasProcess() const { return child && child->IsRunning(); }
  // Whether others may rely on what it has shown: it was ready, or that did not come about.
  [[nodiscard]] bool IsSettled() const { return keeper.HasBeenReady() || keeper.Deaths() > 0 || IsOver(); }
};

// What came of a part since the last call: lines for people, in the order in which they belong.
struct PartNews {
  std::vector<std::string> errors;  // what it wrote on standard error
  std::string change;               // a death, or that it is back; empty: neither
  bool isReady = false;             // it became ready
};

// The port that its ready line names, the first number of "listening on UDP port 7777, scene arena"; 0: none.
[[nodiscard]] std::uint16_t ReadPort(const Part& part);

// Starts the process. In kWaiting. Returns what failed, which counts as a death; empty: nothing.
[[nodiscard]] std::string StartPart(Part& part, const std::vector<std::string>& command, double now);

// Reads what the process has written, notes when it is ready and when it has ended, and kills one that is late. Never
// waits.
[[nodiscard]] PartNews FollowPart(Part& part, double now);

}  // namespace wobble::host
