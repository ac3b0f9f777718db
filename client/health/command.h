// `wobble health`: its options.
#pragma once

#include "client/command/command.h"

namespace wobble::health {

[[nodiscard]] command::Command DescribeHealth(CLI::App& app);

}  // namespace wobble::health
