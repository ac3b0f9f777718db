// What is said of a fleet while it runs, and at its end.
#pragma once

#include <deque>
#include <filesystem>
#include <string>
#include <vector>

#include "client/host/part.h"

namespace wobble::host {

// Where a part writes its summary.
[[nodiscard]] std::filesystem::path SummaryOf(const Part& part, const std::filesystem::path& folder);

// How often parts were ready again after a death.
[[nodiscard]] unsigned CountRestarts(const std::deque<Part>& parts);

// One line: of the first world, the gateway and the first bots the latest, and what is not as it should be. left:
// seconds until the end, or infinite.
[[nodiscard]] std::string FormatStatus(const std::deque<Part>& parts, double left);

// What does not run although it is to, one line each. Before the parts are asked to end.
[[nodiscard]] std::vector<std::string> FindFailures(const std::deque<Part>& parts);

// Prints what each part measured, how often it was started again, and what failed, which `failures` begins. folder: of
// SummaryOf. isEarly: bots had no time to join. now: as for keepers. Returns the exit code.
[[nodiscard]] int Report(const std::deque<Part>& parts, const std::filesystem::path& folder, bool isEarly, double now,
                         std::vector<std::string> failures);

}  // namespace wobble::host
