// The words of `wobble bots`.
#pragma once

#include "client/tool/command.h"

namespace wobble::bots {

[[nodiscard]] tool::Command DescribeBots(CLI::App& app);

}  // namespace wobble::bots
