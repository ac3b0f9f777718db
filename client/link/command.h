// `wobble link`: its options.
#pragma once

#include "client/command/command.h"

namespace wobble::link {

[[nodiscard]] command::Command DescribeLink(CLI::App& app);

}  // namespace wobble::link
