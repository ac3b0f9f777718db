// The options and the help of `wobble bots`. The room client/bots holds the load test: players whose input comes from a
// Lua script, and the measurement of how the server serves them.
#pragma once

#include "client/command/command.h"

namespace wobble::bots {

[[nodiscard]] command::Command DescribeBots(CLI::App& app);

}  // namespace wobble::bots
