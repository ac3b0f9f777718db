// Finds the worlds that servers announce in the local network (_wobble._udp by DNS-SD over multicast DNS): by Avahi's
// daemon where one runs, and else by itself.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "client/list/world.h"

namespace wobble::list {

// Listens for so long, s. A world that has several addresses is listed once, by IPv4 if it has that.
// Worlds that have link-local IPv6 addresses alone are left out. Empty with one line in `error` when nothing can be
// browsed.
[[nodiscard]] std::vector<World> BrowseLan(double seconds, const std::function<bool()>& isStopAsked,
                                           std::string& error);

}  // namespace wobble::list
