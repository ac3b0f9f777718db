// `wobble token`: its options.
#pragma once

#include "client/command/command.h"

namespace wobble::token {

[[nodiscard]] command::Command DescribeToken(CLI::App& app);

}  // namespace wobble::token
