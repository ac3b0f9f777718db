// The words of `wobble play`.
#pragma once

#include "client/tool/command.h"

namespace wobble::play {

[[nodiscard]] tool::Command DescribePlay(CLI::App& app);

}  // namespace wobble::play
