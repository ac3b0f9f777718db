// The words of `wobble bots`.
#pragma once

#include "client/command/command.h"

namespace wobble::bots {

[[nodiscard]] tool::Command DescribeBots(CLI::App& app);

}  // namespace wobble::bots
