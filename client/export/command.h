// `wobble export`: its options.
#pragma once

#include "client/command/command.h"

namespace wobble::exporting {

[[nodiscard]] command::Command DescribeExport(CLI::App& app);

}  // namespace wobble::exporting
