// What one call of a function of Lua's string and table libraries may cost, in instructions. They run in C, where no
// hook counts: a pattern with a few wildcards and a text of some hundred bytes can take hours.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

struct lua_State;

namespace wobble::bots {

// The worst case of the call whose arguments are on the stack. name: as in its library; "rep" is string.rep. May raise
// a Lua error when the arguments are not what the function takes.
[[nodiscard]] std::int64_t FindCallCost(lua_State* lua, std::string_view name);

// Steps that Lua's matcher takes at most to try a pattern on so many bytes, from every start unless it is anchored.
[[nodiscard]] double CountPatternSteps(std::size_t bytes, std::string_view pattern, bool anchored);

}  // namespace wobble::bots
