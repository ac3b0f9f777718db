// Lua's matcher backtracks: a pattern with k repeats has C(n + k, k) ways to divide n bytes among them, and the matcher
// tries them all before it fails. The start of the match counts as one more repeat. That worst case is taken as the
// cost, so a call that happens to be cheap is charged like an expensive one; names and lines of text are short enough
// for it.
//
// Replacing the matcher by one without backtracking was rejected: it would be a second dialect of patterns.
//
// A cost must not be less than the work for any arguments, because nothing else stops a call. So an empty string counts
// as often as it is repeated; a number counts as the string that the library makes of it; and a length that a script's
// __len answers counts as the most, because it may answer another one when the library asks again.
#include "client/bots/lua_costs.h"

#include <algorithm>
#include <cmath>
#include <lua.hpp>

namespace wobble::bots {
namespace {

// Work that C does in the time of one Lua instruction: bytes moved, steps of the matcher, values passed.
constexpr double kBytes = 64;
constexpr double kPatternSteps = 10;
constexpr double kValues = 10;
// Instructions for writing one value with string.format: %.99f of a large number has 400 digits.
constexpr double kFormatted = 10;
// Bytes of a pattern per matcher step: a character class is scanned for every byte it is compared with.
constexpr double kPatternBytes = 16;
constexpr double kMost = 1e15;

// NaN, which a script may pass as a number of times, is the most.
std::int64_t ToInstructions(double cost) {
  return static_cast<std::int64_t>(cost < kMost ? std::max(cost, 0.0) : kMost);
}

// Turns a number into a string, as the library is about to do.
std::string_view TextOf(lua_State* lua, int index) {
  std::size_t length = 0;
  const char* text = lua_isstring(lua, index) != 0 ? lua_tolstring(lua, index, &length) : "";
  return {text, length};
}

double LengthOf(lua_State* lua, int index) { return static_cast<double>(TextOf(lua, index).size()); }

// The elements of a table, or of another value with a metatable that passes for one.
double CountElements(lua_State* lua, int index) {
  if (luaL_getmetafield(lua, index, "__len") == LUA_TNIL) return static_cast<double>(lua_rawlen(lua, index));
  lua_pop(lua, 1);
  return kMost;
}

// Number of elements from the argument `first` to the argument `last`, by default 1 and the table's length.
double CountRange(lua_State* lua, int table, int first, int last) {
  const double from = static_cast<double>(luaL_optinteger(lua, first, 1));
  const double to = lua_isnoneornil(lua, last) ? CountElements(lua, table) : luaL_checknumber(lua, last);
  return std::max(0.0, to - from + 1);
}

double FindPatternCost(lua_State* lua, std::string_view name) {
  const double bytes = LengthOf(lua, 1);
  const std::string_view pattern = TextOf(lua, 2);
  if (name == "string.find" && lua_toboolean(lua, 4) != 0) return bytes * (1 + LengthOf(lua, 2) / kBytes) / kBytes;
  const bool anchored = name != "string.gmatch" && pattern.starts_with('^');  // gmatch reads '^' as a character
  double steps = CountPatternSteps(static_cast<std::size_t>(bytes), pattern, anchored);
  // The replacement is scanned for each match, of which there may be one before every byte and one at the end.
  if (name == "string.gsub") steps += (bytes + 1) * LengthOf(lua, 3);
  return steps / kPatternSteps;
}

double FindTableCost(lua_State* lua, std::string_view name) {
  const double elements = CountElements(lua, 1);
  if (name == "table.insert") return lua_gettop(lua) > 2 ? elements : 0;  // inserting at the end moves nothing
  if (name == "table.remove") return lua_gettop(lua) > 1 ? elements : 0;
  if (name == "table.sort") return elements * std::log2(elements + 2) * 2;
  if (name == "table.concat") return CountRange(lua, 1, 3, 4);
  if (name == "table.unpack") return CountRange(lua, 1, 2, 3);
  if (name == "table.move") return CountRange(lua, 1, 2, 3);
  return 0;
}

double FindFormatCost(lua_State* lua) { return LengthOf(lua, 1) / kPatternSteps + lua_gettop(lua) * kFormatted; }

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
  if (name == "string.find" || name == "string.match" || name == "string.gmatch" || name == "string.gsub") {
    return ToInstructions(FindPatternCost(lua, name));
  }
  if (name == "string.rep") {
    const double bytes = LengthOf(lua, 1) + LengthOf(lua, 3);
    return ToInstructions(std::max(bytes, 1.0) * luaL_checknumber(lua, 2) / kBytes);
  }
  double cost = lua_gettop(lua) / kValues;
  if (name == "string.format") cost += FindFormatCost(lua);
  if (name.starts_with("table.") && lua_gettop(lua) > 0) cost += FindTableCost(lua, name);
  double bytes = 0;
  for (int i = 1; i <= lua_gettop(lua); ++i) bytes += lua_type(lua, i) == LUA_TSTRING ? LengthOf(lua, i) : 0;
  return ToInstructions(cost + bytes / kBytes);
}

}  // namespace wobble::bots
