// Upper bounds, in Lua instructions, of what one call of a function of Lua's libraries costs. These functions run in C,
// where no instruction hook counts, and a pattern with a few wildcards on a text of some hundred bytes can take hours.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

struct lua_State;

namespace wobble::bots {

// Worst-case cost of the call whose arguments are on the stack, in Lua instructions. name: the function's with its
// library's, such as "string.rep". May raise a Lua error when the arguments have wrong types.
[[nodiscard]] std::int64_t FindCallCost(lua_State* lua, std::string_view name);

// Upper bound of the steps that Lua's matcher takes to try `pattern` on `bytes` bytes: from every start, or from the
// first alone when `anchored`.
[[nodiscard]] double CountPatternSteps(std::size_t bytes, std::string_view pattern, bool anchored);

}  // namespace wobble::bots
