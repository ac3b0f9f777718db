// The words of `wobble health`.
#pragma once

#include "client/tool/command.h"

namespace wobble::health {

[[nodiscard]] tool::Command DescribeHealth(CLI::App& app);

}  // namespace wobble::health
