// The command lines of a fleet's programs. summary: the file that they leave their figures in.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "client/host/plan.h"

namespace wobble::host {

// world: its number in the plan. port: UDP; 0: a free one.
[[nodiscard]] std::vector<std::string> MakeWorldCommand(const Plan& plan, std::size_t world, std::uint16_t port,
                                                        const std::string& summary);

// For a plan that has a gateway. port: TCP; 0: a free one. servers: NAME=ADDRESS.
[[nodiscard]] std::vector<std::string> MakeGatewayCommand(const Plan& plan, std::uint16_t port,
                                                          const std::vector<std::string>& servers);

// Of the bots of a world, which is at this address.
[[nodiscard]] std::vector<std::string> MakeBotsCommand(const Plan& plan, std::size_t world, const std::string& address,
                                                       const std::string& summary);

}  // namespace wobble::host
