// `wobble admin`: its options.
#pragma once

#include "client/command/command.h"

namespace wobble::admin {

[[nodiscard]] command::Command DescribeAdmin(CLI::App& app);

}  // namespace wobble::admin
