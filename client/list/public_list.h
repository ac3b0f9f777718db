// Reads a public list of worlds (command/world_list.h): those of it that programs can reach.
#pragma once

#include <string>
#include <vector>

#include "client/list/world.h"

namespace wobble::list {

// where: http://..., https://... or a file. Empty with one line in `error`; so it is when no world of the list has an
// address. Names of hosts are resolved, which may block for as long as the system's resolver does; those that are not
// known have no `resolved`.
[[nodiscard]] std::vector<World> ReadList(const std::string& where, std::string& error);

}  // namespace wobble::list
