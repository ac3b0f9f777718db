// The options and the help of `wobble watch`. The room client/terminal holds the client that draws the world as
// character cells and plays with the keys.
#pragma once

#include "client/command/command.h"

namespace wobble::terminal {

[[nodiscard]] command::Command DescribeWatch(CLI::App& app);

}  // namespace wobble::terminal
