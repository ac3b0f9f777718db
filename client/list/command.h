// `wobble list`: its options.
#pragma once

#include "client/command/command.h"

namespace wobble::list {

[[nodiscard]] command::Command DescribeList(CLI::App& app);

}  // namespace wobble::list
