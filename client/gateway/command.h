// `wobble gateway`: its options.
#pragma once

#include "client/command/command.h"

namespace wobble::gateway {

[[nodiscard]] command::Command DescribeGateway(CLI::App& app);

// The folder of the page that lies beside the program.
[[nodiscard]] std::filesystem::path FindPageFolder();

}  // namespace wobble::gateway
