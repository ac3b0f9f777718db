// Lua's matcher backtracks: a pattern with k repeats has C(n + k, k) ways to divide n bytes among them, and the matcher
// tries them all before it fails. The start of the match counts as one more repeat. That worst case is taken as the
// cost, so a call that happens to be cheap is charged like an expensive one; names and lines of text are short enough
// for it.
//
// Replacing the matcher by one without backtracking was rejected: it would be a second dialect of patterns.
#include "client/bots/lua_costs.h"

#include <algorithm>
#include <cmath>
#include <lua.hpp>

namespace wobble::bots {
namespace {

// Work that C does in the time of one Lua instruction: bytes moved, steps of the matcher.
constexpr double kBytes = 64;
constexpr double kPatternSteps = 10;
// Bytes of a pattern per matcher step: a character class is scanned for every byte it is compared with.
constexpr double kPatternBytes = 16;
constexpr double kMost = 1e15;

std::int64_t ToInstructions(double cost) { return static_cast<std::int64_t>(std::clamp(cost, 0.0, kMost)); }

double LengthOf(lua_State* lua, int index) {
  std::size_t length = 0;
  if (lua_type(lua, index) == LUA_TSTRING) lua_tolstring(lua, index, &length);
  return static_cast<double>(length);
}

double CountElements(lua_State* lua, int index) {
  return lua_istable(lua, index) ? static_cast<double>(luaL_len(lua, index)) : 0;
}

// Number of elements from the argument `first` to the argument `last`, by default 1 and the table's length.
double CountRange(lua_State* lua, int table, int first, int last) {
  const double from = static_cast<double>(luaL_optinteger(lua, first, 1));
  const double to = lua_isnoneornil(lua, last) ? CountElements(lua, table) : luaL_checknumber(lua, last);
  return std::max(0.0, to - from + 1);
}

double FindPatternCost(lua_State* lua, std::string_view name) {
  if (lua_type(lua, 1) != LUA_TSTRING || lua_type(lua, 2) != LUA_TSTRING) return 0;
  if (name == "find" && lua_toboolean(lua, 4) != 0) return LengthOf(lua, 1) * (1 + LengthOf(lua, 2) / kBytes) / kBytes;
  std::size_t length = 0;
  const char* text = lua_tolstring(lua, 2, &length);
  const std::string_view pattern(text, length);
  const bool anchored = name != "gmatch" && pattern.starts_with('^');  // gmatch reads '^' as a character
  return CountPatternSteps(static_cast<std::size_t>(LengthOf(lua, 1)), pattern, anchored) / kPatternSteps;
}

double FindTableCost(lua_State* lua, std::string_view name) {
  const double elements = CountElements(lua, 1);
  if (name == "insert") return lua_gettop(lua) > 2 ? elements : 0;  // inserting at the end moves nothing
  if (name == "remove") return lua_gettop(lua) > 1 ? elements : 0;
  if (name == "sort") return elements * std::log2(elements + 2) * 2;
  if (name == "concat") return CountRange(lua, 1, 3, 4);
  if (name == "unpack") return CountRange(lua, 1, 2, 3);
  if (name == "move") return CountRange(lua, 1, 2, 3);
  return 0;
}

}  // namespace

double CountPatternSteps(std::size_t bytes, std::string_view pattern, bool anchored) {
  int repeats = anchored ? 0 : 1;
  for (std::size_t i = 0; i < pattern.size(); ++i) {
    const char c = pattern[i];
    if (c == '%' && i + 1 < pattern.size()) {
      const char next = pattern[++i];
      repeats += next == 'b' || (next >= '0' && next <= '9') ? 1 : 0;  // %bxy and %1 scan what they match
    } else {
      repeats += c == '*' || c == '+' || c == '-' || c == '?' ? 1 : 0;
    }
  }
  double ways = 1;
  for (int i = 1; i <= repeats && ways < kMost; ++i) ways *= (static_cast<double>(bytes) + i) / i;
  return ways * (1 + static_cast<double>(pattern.size()) / kPatternBytes);
}

std::int64_t FindCallCost(lua_State* lua, std::string_view name) {
  if (name == "find" || name == "match" || name == "gmatch" || name == "gsub") {
    return ToInstructions(FindPatternCost(lua, name));
  }
  if (name == "rep") {
    return ToInstructions((LengthOf(lua, 1) + LengthOf(lua, 3)) * luaL_checknumber(lua, 2) / kBytes);
  }
  if (lua_istable(lua, 1)) return ToInstructions(FindTableCost(lua, name));
  double bytes = 0;
  for (int i = 1; i <= lua_gettop(lua); ++i) bytes += LengthOf(lua, i);
  return ToInstructions(bytes / kBytes);
}

}  // namespace wobble::bots
