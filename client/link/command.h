// The words of `wobble link`.
#pragma once

#include "client/tool/command.h"

namespace wobble::link {

[[nodiscard]] tool::Command DescribeLink(CLI::App& app);

}  // namespace wobble::link
