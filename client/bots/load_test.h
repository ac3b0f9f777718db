// `wobble bots`: a load test from its options to its exit code.
#pragma once

#include <functional>

#include "client/bots/options.h"

namespace wobble::bots {

// Runs until its time is up, stopAsked is true or nothing is left to do. Reports on standard output, complains on
// standard error, writes the summary file in every case but an unusable script or file. Returns the exit code.
[[nodiscard]] int RunLoadTest(const LoadTestOptions& options, const std::function<bool()>& stopAsked);

}  // namespace wobble::bots
