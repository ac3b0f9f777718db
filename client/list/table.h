// Worlds for people and for programs.
#pragma once

#include <string>
#include <vector>

#include "client/list/world.h"

namespace wobble::list {

// A line each below a line of headings: name, address, scene, players of places, ping. "-" is what is not known.
[[nodiscard]] std::string WriteTable(const std::vector<World>& worlds);
// An array of objects; null is what is not known.
[[nodiscard]] std::string WriteJson(const std::vector<World>& worlds);

}  // namespace wobble::list
