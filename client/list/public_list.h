// Reads a public list of worlds: a JSON object whose "worlds" are objects with an "address" (HOST:PORT) and, where it
// is known, "name", "scene", "version" and "key" (server/HOSTING.md, "Found by friends").
#pragma once

#include <string>
#include <vector>

#include "client/list/world.h"

namespace wobble::list {

inline constexpr std::size_t kMaxListBytes = 1024 * 1024;
inline constexpr std::size_t kMaxListedWorlds = 1000;

// Of the text of a list. Empty with one line in `error`, which names entry and field; so it is when the list is empty.
[[nodiscard]] std::vector<World> ParseList(const std::string& text, std::string& error);

// where: http://..., https://... or a file. Names of hosts are resolved, which may block for as long as the system's
// resolver does; those that are not known have no `resolved`.
[[nodiscard]] std::vector<World> ReadList(const std::string& where, std::string& error);

}  // namespace wobble::list
