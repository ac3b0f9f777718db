// The words of `wobble watch`.
#pragma once

#include "client/command/command.h"

namespace wobble::terminal {

[[nodiscard]] tool::Command DescribeWatch(CLI::App& app);

}  // namespace wobble::terminal
