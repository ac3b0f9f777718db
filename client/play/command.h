// `wobble play`: its options.
#pragma once

#include "client/command/command.h"

namespace wobble::play {

[[nodiscard]] command::Command DescribePlay(CLI::App& app);

}  // namespace wobble::play
