// Asks worlds what is played in them, by Valve's server query.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "client/list/world.h"

namespace wobble::list {

// Fills in `told` and `ping` of the worlds that answer, all at once, within `seconds`. False with one line in `error`
// when no socket can be opened.
[[nodiscard]] bool AskWorlds(std::vector<World>& worlds, double seconds, const std::function<bool()>& isStopAsked,
                             std::string& error);

}  // namespace wobble::list
