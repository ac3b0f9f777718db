// A load test from its options to its exit code.
#pragma once

#include <functional>

#include "client/bots/options.h"

namespace wobble::bots {

// Runs until the configured time is over, stopAsked returns true or all bots have ended. Reports on standard output and
// writes errors to standard error. Writes the summary file in every case except an unusable script or file. Returns the
// exit code: 0 all thresholds hold, 99 one fails, 2 broken script, unusable file or no server.
[[nodiscard]] int RunLoadTest(const LoadTestOptions& options, const std::function<bool()>& stopAsked);

}  // namespace wobble::bots
