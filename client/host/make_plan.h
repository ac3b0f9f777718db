// From worlds.toml to what is run.
#pragma once

#include <filesystem>

#include "client/host/plan.h"
#include "client/host/worlds_file.h"

namespace wobble::host {

// Where a fleet keeps what outlives it: states, bans, trained bases and the key of its gateway.
[[nodiscard]] std::filesystem::path FindStateFolder(const WorldsFile& file, const std::filesystem::path& otherwise);

// folder: of FindStateFolder.
[[nodiscard]] WorldPlan MakeWorldPlan(const WorldsFile& file, const World& world, const std::filesystem::path& folder);
[[nodiscard]] GatewayPlan MakeGatewayPlan(const WorldsFile& file, const std::filesystem::path& folder);

}  // namespace wobble::host
