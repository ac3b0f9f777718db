// The coroutines of a script's bots: creation, resumption when the awaited condition holds, and termination with one
// line on an error.
//
// A coroutine yields only in bot:wait, bot:leave and bot:join (or coroutine.yield, which waits for the next round), so
// a script reads as a sequence: move, wait, jump. A callback per tick was rejected; every script would then be a state
// machine.
#include "client/bots/script.h"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <lua.hpp>
#include <sstream>
#include <utility>

#include "protocol/text.h"

namespace wobble::bots {
namespace {

constexpr const char* kRunKey = "wobble.run";

// Seconds that a wait may end early: rounds come at multiples of a time that is not exact in binary.
constexpr double kTimeTolerance = 1e-6;

// Bytes of an error message that are shown: nested coroutines each prepend their position.
constexpr std::size_t kMaxMessageBytes = 400;

// Returns the error message as one line; a script may raise what it was told by the server.
std::string ReadMessage(lua_State* lua) {
  std::size_t length = 0;
  const char* text = lua_type(lua, -1) == LUA_TSTRING ? lua_tolstring(lua, -1, &length) : nullptr;
  std::string message = text != nullptr ? std::string(text, length)
                                        : "error value is a " + std::string(luaL_typename(lua, -1)) + ", not a text";
  const bool isLong = message.size() > kMaxMessageBytes;
  message = protocol::MakeLine(message, kMaxMessageBytes);
  return isLong ? message + " ..." : message;
}

// As ReadMessage, with the innermost active line added when the message has none, as after error(text, 0) or an error
// with a table.
std::string ReadMessageWithPlace(lua_State* lua) {
  std::string message = ReadMessage(lua);
  lua_Debug where;
  for (int level = 0; lua_getstack(lua, level, &where) != 0; ++level) {
    lua_getinfo(lua, "Sl", &where);
    if (where.currentline <= 0) continue;
    const std::string file = std::string(where.short_src) + ":";
    if (message.compare(0, file.size(), file) != 0) message = file + std::to_string(where.currentline) + ": " + message;
    break;
  }
  return message;
}

}  // namespace

bool Script::Bot::IsDue() const {
  if (result != Result::kRunning) return false;
  switch (awaited) {
    case Awaited::kTime:
      return view.time + kTimeTolerance >= wake;
    case Awaited::kPlaying:
      return view.isPlaying;
    case Awaited::kAway:
      return view.isAway;
  }
  return false;
}

Script::Script(std::uint64_t seed, LuaSandbox::Log log)
    : m_sandbox(seed, std::move(log)), m_loader(m_sandbox.MakeCaller(0)) {}
Script::~Script() = default;

bool Script::LoadFile(const std::string& path, std::string& error) {
  errno = 0;
  std::ifstream file(path, std::ios::binary);
  std::ostringstream source;
  if (!file || !(source << file.rdbuf())) {
    error = path + ": cannot be read" + (errno != 0 ? std::string(": ") + std::strerror(errno) : "");
    return false;
  }
  return Load(source.str(), path, error);
}

bool Script::Load(const std::string& source, const std::string& name, std::string& error) {
  lua_State* lua = m_sandbox.State();
  if (lua == nullptr) {
    error = name + ": no memory for a Lua state";
    return false;
  }
  m_sandbox.BeginCall(m_loader);
  const std::string chunk = "@" + name;
  if (luaL_loadbufferx(lua, source.data(), source.size(), chunk.c_str(), "t") != LUA_OK ||
      lua_pcall(lua, 0, 0, 0) != LUA_OK) {
    error = ReadMessage(lua);
    // Lua begins a message with the file name, or with "..." and the end of a long one; error(text, 0) and the like
    // begin with neither.
    if (error.compare(0, name.size(), name) != 0 && error.compare(0, 3, "...") != 0) error = name + ": " + error;
    lua_settop(lua, 0);
    return false;
  }
  m_sandbox.BeginCall(m_loader);
  lua_pushcfunction(lua, &Script::PrepareBots);
  if (lua_pcall(lua, 0, 0, 0) != LUA_OK) {
    error = name + ": " + ReadMessage(lua);
    lua_settop(lua, 0);
    return false;
  }
  return true;
}

// Makes the type of `bot`, and keeps run where no script can reach it.
int Script::PrepareBots(lua_State* lua) {
  MakeBotType(lua);
  lua_pushglobaltable(lua);
  lua_pushliteral(lua, "run");
  if (lua_rawget(lua, -2) != LUA_TFUNCTION) {
    lua_pushliteral(lua, "defines no function run(bot)");
    return lua_error(lua);
  }
  lua_setfield(lua, LUA_REGISTRYINDEX, kRunKey);
  return 0;
}

unsigned Script::AddBot(std::string& error) {
  lua_State* lua = m_sandbox.State();
  auto bot = std::make_unique<Bot>();
  bot->script = this;
  bot->caller = m_sandbox.MakeCaller(static_cast<unsigned>(m_bots.size()) + 1);
  m_sandbox.BeginCall(m_loader);
  lua_pushcfunction(lua, &Script::CreateCoroutine);
  lua_pushlightuserdata(lua, bot.get());
  if (lua_pcall(lua, 1, 0, 0) != LUA_OK) {
    error = ReadMessage(lua);
    lua_settop(lua, 0);
    return 0;
  }
  m_bots.push_back(std::move(bot));
  return m_bots.back()->caller.number;
}

int Script::CreateCoroutine(lua_State* lua) {
  Bot* bot = static_cast<Bot*>(lua_touserdata(lua, 1));
  bot->thread = lua_newthread(lua);
  lua_getfield(lua, LUA_REGISTRYINDEX, kRunKey);
  PushBot(lua, bot);
  lua_xmove(lua, bot->thread, 2);
  bot->reference = luaL_ref(lua, LUA_REGISTRYINDEX);
  return 0;
}

Script::Result Script::Resume(unsigned number, const View& view, Wish& wish, std::string& error) {
  Bot& bot = *m_bots[number - 1];
  if (bot.jumpRounds > 0) --bot.jumpRounds;
  bot.view = view;
  if (bot.IsDue()) Continue(bot, error);
  wish = bot.wish;
  bot.wish.deeds.clear();
  wish.input.jump = bot.jumpRounds > 0;
  return bot.result;
}

void Script::Continue(Bot& bot, std::string& error) {
  bot.awaited = Awaited::kTime;
  bot.wake = bot.view.time;  // coroutine.yield leaves it at that value
  m_sandbox.BeginCall(bot.caller);
  int results = 0;
  const int status = lua_resume(bot.thread, m_sandbox.State(), bot.started ? 0 : 1, &results);
  bot.started = true;
  if (status == LUA_YIELD) {
    lua_pop(bot.thread, results);
    return;
  }
  bot.result = status == LUA_OK ? Result::kFinished : Result::kFailed;
  if (status != LUA_OK) {
    error = ReadMessageWithPlace(bot.thread);
    bot.wish.input = {};
    bot.wish.hand.reset();
    bot.wish.deeds.clear();
    bot.jumpRounds = 0;
  }
  luaL_unref(m_sandbox.State(), LUA_REGISTRYINDEX, bot.reference);
  bot.thread = nullptr;
  if (status != LUA_OK) m_sandbox.FreeUnused();
}

}  // namespace wobble::bots
