// One state serves all bots, because a state costs 20 KiB and a coroutine 1 KiB. Each call belongs to one bot, with its
// own budget, its own random generator and its own number on printed lines.
//
// The budget is enforced by a count hook, which every coroutine inherits. Once the budget is spent the hook fires at
// every instruction, because a script could otherwise catch the error with pcall and go on; now the first instruction
// after the pcall raises it again. Lua calls no hook inside a finaliser, so setmetatable refuses __gc; nor inside
// xpcall's handler when the hook itself raised the error, so there is no xpcall.
//
// A hook does not see how much work one instruction does. Calls of functions whose work grows with their arguments are
// therefore charged with their worst case before they run (lua_costs.h); that includes the arithmetic of strings, which
// is functions in the metatable of strings. Memory is charged by the byte when it is allocated, and a refused block by
// the collection that Lua then tries. What stays uncharged is single instructions that compare or convert a string, or
// copy a list of arguments: sizes of strings and blocks are bounded so that a call made of these alone ends within
// seconds.
//
// Lua is built as C, so its errors are longjmps: no function here holds an object with a destructor when it raises one.
#include "client/bots/lua_sandbox.h"

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <lua.hpp>
#include <utility>

#include "client/bots/lua_costs.h"

namespace wobble::bots {
namespace {

// Instructions between two checks of the budget; at 1,000 the cost of the hook is not measurable.
constexpr int kHookInterval = 1000;
// Allocated bytes that count as one instruction.
constexpr std::int64_t kBytesPerInstruction = 64;
// A string's own bytes beside its text, at most.
constexpr std::size_t kStringHeadBytes = 32;
// Instructions charged for a line that is printed, and bytes of it that count as one more.
constexpr std::int64_t kPrintCost = 20;
constexpr std::int64_t kPrintedBytesPerInstruction = 8;

void Forget(lua_State* lua, const char* name) {
  lua_pushnil(lua);
  lua_setfield(lua, -2, name);
}

void Replace(lua_State* lua, const char* name, lua_CFunction function) {
  lua_pushcfunction(lua, function);
  lua_setfield(lua, -2, name);
}

}  // namespace

LuaSandbox::LuaSandbox(std::uint64_t seed, Log log) : m_seed(seed), m_log(std::move(log)) {
  m_nobody = MakeCaller(0);
  m_state = lua_newstate(&LuaSandbox::Allocate, this);
  if (m_state == nullptr) return;
  LuaSandbox* self = this;
  std::memcpy(lua_getextraspace(m_state), &self, sizeof self);  // copied into every coroutine
  lua_sethook(m_state, &LuaSandbox::CountInstructions, LUA_MASKCOUNT, kHookInterval);
  lua_pushcfunction(m_state, &LuaSandbox::OpenLibraries);
  if (lua_pcall(m_state, 0, 0, 0) != LUA_OK) {
    lua_close(m_state);
    m_state = nullptr;
  }
}

LuaSandbox::~LuaSandbox() {
  if (m_state != nullptr) lua_close(m_state);
}

LuaSandbox::Caller LuaSandbox::MakeCaller(unsigned number) const {
  protocol::Random mixed(protocol::Random(m_seed).Next() + number);
  return {number, protocol::Random(mixed.Next())};
}

void LuaSandbox::BeginCall(Caller& caller) {
  m_caller = &caller;
  m_budget = kCallBudget;
}

void LuaSandbox::FreeUnused() {
  if (m_bytes > kMaxMemoryBytes / 4) lua_gc(m_state, LUA_GCCOLLECT);
}

LuaSandbox& LuaSandbox::Of(lua_State* lua) {
  LuaSandbox* sandbox = nullptr;
  std::memcpy(&sandbox, lua_getextraspace(lua), sizeof sandbox);
  return *sandbox;
}

void* LuaSandbox::Allocate(void* sandbox, void* block, std::size_t oldBytes, std::size_t newBytes) {
  auto& self = *static_cast<LuaSandbox*>(sandbox);
  const bool isString = block == nullptr && oldBytes == LUA_TSTRING;
  if (block == nullptr) oldBytes = 0;  // Lua passes the kind of the new object in oldBytes
  if (newBytes == 0) {
    std::free(block);
    self.m_bytes -= oldBytes;
    return nullptr;
  }
  if (newBytes > oldBytes) {
    // Lua collects all garbage and asks a second time. A script whose blocks are too large pays for the collections;
    // one that meets the bound of all scripts' memory may not be to blame, and only must not do so all the time.
    if (newBytes > (isString ? kMaxStringBytes + kStringHeadBytes : kMaxBlockBytes)) {
      self.m_budget -= static_cast<std::int64_t>(self.m_bytes) / kBytesPerInstruction;
      return nullptr;
    }
    if (self.m_bytes - oldBytes + newBytes > kMaxMemoryBytes) {
      self.m_budget -= kCallBudget / 10;
      return nullptr;
    }
    self.m_budget -= static_cast<std::int64_t>(newBytes) / kBytesPerInstruction;
  }
  void* moved = std::realloc(block, newBytes);
  if (moved != nullptr) self.m_bytes += newBytes - oldBytes;
  return moved;
}

void LuaSandbox::CountInstructions(lua_State* lua, lua_Debug* where) {
  LuaSandbox& self = Of(lua);
  const int interval = lua_gethookcount(lua);
  if (self.m_budget > interval) {
    self.m_budget -= interval;
    if (interval != kHookInterval) lua_sethook(lua, &LuaSandbox::CountInstructions, LUA_MASKCOUNT, kHookInterval);
    return;
  }
  self.m_budget = 0;
  lua_sethook(lua, &LuaSandbox::CountInstructions, LUA_MASKCOUNT, 1);
  lua_getinfo(lua, "Sl", where);
  lua_pushfstring(lua, "%s:%d: stopped after %d instructions without a bot:wait; an endless loop?", where->short_src,
                  where->currentline, kCallBudget);
  lua_error(lua);
}

void LuaSandbox::Charge(lua_State* lua, std::int64_t instructions) {
  LuaSandbox& self = Of(lua);
  self.m_budget -= instructions;
  if (self.m_budget > 0) return;
  self.m_budget = 0;
  lua_sethook(lua, &LuaSandbox::CountInstructions, LUA_MASKCOUNT, 1);
  luaL_error(lua, "stopped: with what this call may cost, more than %d instructions without a bot:wait", kCallBudget);
}

// Calls the library's function (the first upvalue) in this very frame, so that its messages name line and function as
// they would without the wrapper. The library's functions have no upvalues of their own. The second upvalue is the name
// for lua_costs.
int LuaSandbox::CallCharged(lua_State* lua) {
  std::size_t length = 0;
  const char* name = lua_tolstring(lua, lua_upvalueindex(2), &length);
  Charge(lua, FindCallCost(lua, {name, length}));
  return lua_tocfunction(lua, lua_upvalueindex(1))(lua);
}

// Wraps the function of the table on top of the stack with CallCharged, if the table has it.
void LuaSandbox::ChargeFunction(lua_State* lua, const char* library, const char* name) {
  if (lua_getfield(lua, -1, name) == LUA_TFUNCTION && lua_iscfunction(lua, -1)) {
    lua_pushfstring(lua, "%s.%s", library, name);
    lua_pushcclosure(lua, &LuaSandbox::CallCharged, 2);
    lua_setfield(lua, -2, name);
  } else {
    lua_pop(lua, 1);
  }
}

// Wraps every function of the table on top of the stack. Assigning to fields that exist keeps lua_next's place.
void LuaSandbox::ChargeFunctions(lua_State* lua, const char* library) {
  for (lua_pushnil(lua); lua_next(lua, -2) != 0;) {
    lua_pop(lua, 1);
    lua_pushvalue(lua, -2);
    ChargeFunction(lua, library, lua_tostring(lua, -2));
    lua_pop(lua, 1);
  }
}

int LuaSandbox::AnswerPrint(lua_State* lua) {
  const int count = lua_gettop(lua);
  luaL_Buffer line;
  luaL_buffinit(lua, &line);
  for (int i = 1; i <= count; ++i) {
    if (i > 1) luaL_addchar(&line, '\t');
    luaL_tolstring(lua, i, nullptr);
    luaL_addvalue(&line);
  }
  luaL_pushresult(&line);
  std::size_t length = 0;
  const char* text = lua_tolstring(lua, -1, &length);
  Charge(lua, kPrintCost + static_cast<std::int64_t>(length) / kPrintedBytesPerInstruction);
  const LuaSandbox& self = Of(lua);
  if (self.m_log) self.m_log(self.m_caller->number, {text, length});
  return 0;
}

// Lua's own setmetatable, but refuses __gc.
int LuaSandbox::AnswerSetMetatable(lua_State* lua) {
  luaL_checktype(lua, 1, LUA_TTABLE);
  const int kind = lua_type(lua, 2);
  luaL_argexpected(lua, kind == LUA_TNIL || kind == LUA_TTABLE, 2, "nil or table");
  if (luaL_getmetafield(lua, 1, "__metatable") != LUA_TNIL)
    return luaL_error(lua, "cannot change a protected metatable");
  if (kind == LUA_TTABLE) {
    lua_pushliteral(lua, "__gc");
    if (lua_rawget(lua, 2) != LUA_TNIL) return luaL_error(lua, "__gc is not allowed in a bot's script");
  }
  lua_settop(lua, 2);
  lua_setmetatable(lua, 1);
  return 1;
}

int LuaSandbox::AnswerRandom(lua_State* lua) {
  const int first = lua_isuserdata(lua, 1) ? 2 : 1;  // bot:random(...) passes the bot before its arguments
  const int count = lua_gettop(lua) - first + 1;
  lua_Integer low = 1;
  lua_Integer high = 0;
  if (count > 2) return luaL_error(lua, "wrong number of arguments");
  if (count == 1) high = luaL_checkinteger(lua, first);
  if (count == 2) {
    low = luaL_checkinteger(lua, first);
    high = luaL_checkinteger(lua, first + 1);
  }
  luaL_argcheck(lua, count == 0 || low <= high, first + count - 1, "interval is empty");

  const std::uint64_t bits = Of(lua).m_caller->random.Next();
  if (count == 0) {
    lua_pushnumber(lua, static_cast<double>(bits >> 11) * 0x1p-53);  // [0, 1)
    return 1;
  }
  // Modulo favours low values by less than range / 2^64. A range of 0 stands for all 2^64 integers.
  const std::uint64_t range = static_cast<std::uint64_t>(high) - static_cast<std::uint64_t>(low) + 1;
  const std::uint64_t offset = range == 0 ? bits : bits % range;
  lua_pushinteger(lua, static_cast<lua_Integer>(static_cast<std::uint64_t>(low) + offset));
  return 1;
}

int LuaSandbox::OpenLibraries(lua_State* lua) {
  luaL_requiref(lua, LUA_GNAME, luaopen_base, 1);
  for (const char* name : {"dofile", "loadfile", "load", "require", "collectgarbage", "warn", "xpcall"})
    Forget(lua, name);
  Replace(lua, "print", &LuaSandbox::AnswerPrint);
  Replace(lua, "setmetatable", &LuaSandbox::AnswerSetMetatable);
  for (const char* name : {"tonumber", "select"}) ChargeFunction(lua, "base", name);
  luaL_requiref(lua, LUA_MATHLIBNAME, luaopen_math, 1);
  Forget(lua, "randomseed");
  Replace(lua, "random", &LuaSandbox::AnswerRandom);
  for (const char* name : {"max", "min"}) ChargeFunction(lua, "math", name);
  luaL_requiref(lua, LUA_STRLIBNAME, luaopen_string, 1);
  ChargeFunctions(lua, LUA_STRLIBNAME);
  lua_pushliteral(lua, "");
  lua_getmetatable(lua, -1);
  ChargeFunctions(lua, LUA_STRLIBNAME);
  luaL_requiref(lua, LUA_TABLIBNAME, luaopen_table, 1);
  ChargeFunctions(lua, LUA_TABLIBNAME);
  luaL_requiref(lua, LUA_COLIBNAME, luaopen_coroutine, 1);
  return 0;
}

}  // namespace wobble::bots
