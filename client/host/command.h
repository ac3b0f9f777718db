// `wobble host`: worlds on this machine, a page for them, and what keeps them up, from one file.
#pragma once

#include "client/command/command.h"

namespace wobble::host {

[[nodiscard]] command::Command DescribeHost(CLI::App& app);

}  // namespace wobble::host
