// The methods of `bot`, a userdata that points to a Script::Bot. A method stores the wish in the Script::Bot, from
// where each round takes it, and reads the view that was put there before each resume.
//
// Bodies are listed only when a script asks: 500 bots receive 44 bodies each 30 times a second, and most scripts ask a
// few times a second at most. The cost is charged to the budget per body, as a Lua loop over them would be.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <lua.hpp>

#include "client/bots/script.h"

namespace wobble::bots {
namespace {

constexpr const char* kBotType = "wobble.bot";

// Instructions charged for looking at one body, and for making one table of a body's fields.
constexpr std::int64_t kLookCost = 2;
constexpr std::int64_t kTableCost = 50;
// Bodies that bot:near lists by default: in a crowd of thousands, later ones are not near.
constexpr lua_Integer kNearByDefault = 32;

bool CheckBoolean(lua_State* lua, int index) {
  luaL_checktype(lua, index, LUA_TBOOLEAN);
  return lua_toboolean(lua, index) != 0;
}

double CheckFinite(lua_State* lua, int index) {
  const double value = luaL_checknumber(lua, index);
  luaL_argcheck(lua, std::isfinite(value), index, "must be a finite number");
  return value;
}

double CheckNotNegative(lua_State* lua, int index) {
  const double value = CheckFinite(lua, index);
  luaL_argcheck(lua, value >= 0, index, "must not be negative");
  return value;
}

int PushVector(lua_State* lua, const protocol::Vector3& vector) {
  for (const float coordinate : {vector.x, vector.y, vector.z}) lua_pushnumber(lua, static_cast<double>(coordinate));
  return 3;
}

// Sets a field of the table on top of the stack.
void SetNumber(lua_State* lua, const char* key, double value) {
  lua_pushnumber(lua, value);
  lua_setfield(lua, -2, key);
}

void SetVector(lua_State* lua, const char* x, const char* y, const char* z, const protocol::Vector3& vector) {
  SetNumber(lua, x, static_cast<double>(vector.x));
  SetNumber(lua, y, static_cast<double>(vector.y));
  SetNumber(lua, z, static_cast<double>(vector.z));
}

void SetBody(lua_State* lua, std::uint32_t body) {
  lua_pushinteger(lua, static_cast<lua_Integer>(body));
  lua_setfield(lua, -2, "body");
}

const char* Name(wire::EventKind kind) {
  switch (kind) {
    case wire::EventKind::Join:
      return "join";
    case wire::EventKind::Leave:
      return "leave";
    case wire::EventKind::Respawn:
      return "respawn";
    case wire::EventKind::BodyRemoved:
      return "removed";
    case wire::EventKind::Fall:
      return "fall";
    case wire::EventKind::Said:
      return "said";
    case wire::EventKind::Emote:
      return "emote";
    case wire::EventKind::Rename:
      return "rename";
    case wire::EventKind::Goal:
      return "goal";
    case wire::EventKind::Crown:
      return "crown";
  }
  return "unknown";
}

}  // namespace

void Script::MakeBotType(lua_State* lua) {
  static constexpr luaL_Reg kMethods[] = {
      {"move", &AnswerMove},
      {"jump", &AnswerJump},
      {"puff", &AnswerPuff},
      {"stiffen", &AnswerStiffen},
      {"wait", &AnswerWait},
      {"leave", &AnswerLeave},
      {"join", &AnswerJoin},
      {"time", &AnswerTime},
      {"position", &AnswerPosition},
      {"velocity", &AnswerVelocity},
      {"body", &AnswerBody},
      {"near", &AnswerNear},
      {"events", &AnswerEvents},
      {"id", &AnswerId},
      {"grab", &AnswerGrab},
      {"release", &AnswerRelease},
      {"push", &AnswerPush},
      {"cut", &AnswerCut},
      {"build", &AnswerBuild},
      {"game", &AnswerGame},
      {"random", &LuaSandbox::AnswerRandom},
      {nullptr, nullptr},
  };
  luaL_newmetatable(lua, kBotType);
  luaL_newlib(lua, kMethods);
  lua_setfield(lua, -2, "__index");
  lua_pushboolean(lua, 0);
  lua_setfield(lua, -2, "__metatable");
}

void Script::PushBot(lua_State* lua, Bot* bot) {
  void* self = lua_newuserdatauv(lua, sizeof bot, 0);
  std::memcpy(self, &bot, sizeof bot);
  luaL_setmetatable(lua, kBotType);
}

Script::Bot& Script::SelfOf(lua_State* lua) {
  Bot* bot = nullptr;
  std::memcpy(&bot, luaL_checkudata(lua, 1, kBotType), sizeof bot);
  return *bot;
}

// Yields and does not return. wish: in force from now on.
int Script::Await(lua_State* lua, Bot& bot, Awaited awaited, const Wish& wish) {
  if (lua != bot.thread)
    return luaL_error(lua, "wait, leave and join work only in the bot's own run, not in another coroutine");
  bot.awaited = awaited;
  bot.wish = wish;
  return lua_yield(lua, 0);
}

int Script::AnswerMove(lua_State* lua) {
  Bot& bot = SelfOf(lua);
  const double x = CheckFinite(lua, 2);
  const double y = CheckFinite(lua, 3);
  bot.wish.input.moveX = static_cast<float>(std::clamp(x, -1.0, 1.0));
  bot.wish.input.moveY = static_cast<float>(std::clamp(y, -1.0, 1.0));
  return 0;
}

int Script::AnswerJump(lua_State* lua) {
  SelfOf(lua).jumpRounds = kJumpRounds;
  return 0;
}

int Script::AnswerPuff(lua_State* lua) {
  Bot& bot = SelfOf(lua);
  bot.wish.input.puff = CheckBoolean(lua, 2);
  return 0;
}

int Script::AnswerStiffen(lua_State* lua) {
  Bot& bot = SelfOf(lua);
  bot.wish.input.stiffen = CheckBoolean(lua, 2);
  return 0;
}

int Script::AnswerWait(lua_State* lua) {
  Bot& bot = SelfOf(lua);
  const double seconds = CheckNotNegative(lua, 2);
  bot.wake = bot.view.time + seconds;
  return Await(lua, bot, Awaited::kTime, bot.wish);
}

int Script::AnswerLeave(lua_State* lua) {
  Bot& bot = SelfOf(lua);
  if (!bot.wish.play) return 0;
  return Await(lua, bot, Awaited::kAway, {.input = {}, .play = false});
}

int Script::AnswerJoin(lua_State* lua) {
  Bot& bot = SelfOf(lua);
  if (bot.wish.play) return 0;
  return Await(lua, bot, Awaited::kPlaying, {});
}

int Script::AnswerTime(lua_State* lua) {
  lua_pushnumber(lua, SelfOf(lua).view.time);
  return 1;
}

int Script::AnswerPosition(lua_State* lua) {
  const Bot& bot = SelfOf(lua);
  if (bot.view.self) return PushVector(lua, bot.view.self->pose.centroid);
  lua_pushnil(lua);
  return 1;
}

int Script::AnswerVelocity(lua_State* lua) {
  const Bot& bot = SelfOf(lua);
  if (bot.view.self && bot.view.self->velocity) return PushVector(lua, *bot.view.self->velocity);
  lua_pushnil(lua);
  return 1;
}

int Script::AnswerBody(lua_State* lua) {
  const Bot& bot = SelfOf(lua);
  if (bot.view.isPlaying) {
    lua_pushinteger(lua, static_cast<lua_Integer>(bot.view.body));
  } else {
    lua_pushnil(lua);
  }
  return 1;
}

// Pushes a table of the known fields of a body.
void Script::PushSighting(lua_State* lua, const View& view, const client::Sighting& sighting, double distance) {
  lua_createtable(lua, 0, 10);
  SetBody(lua, sighting.body);
  SetNumber(lua, "distance", distance);
  SetNumber(lua, "age", sighting.age);
  SetVector(lua, "x", "y", "z", sighting.pose.centroid);
  if (sighting.velocity) SetVector(lua, "vx", "vy", "vz", *sighting.velocity);
  if (view.names == nullptr) return;
  const auto name = view.names->find(sighting.body);
  if (name == view.names->end()) return;
  lua_pushlstring(lua, name->second.data(), name->second.size());
  lua_setfield(lua, -2, "name");
}

int Script::AnswerNear(lua_State* lua) {
  Bot& bot = SelfOf(lua);
  const double radius = lua_isnoneornil(lua, 2) ? INFINITY : CheckNotNegative(lua, 2);
  const lua_Integer most = luaL_optinteger(lua, 3, kNearByDefault);
  luaL_argcheck(lua, most >= 1, 3, "must be 1 or more");

  std::vector<client::Sighting>& all = bot.script->m_sightings;
  std::vector<Neighbour>& near = bot.script->m_near;
  all.clear();
  near.clear();
  if (bot.view.self && bot.view.listBodies) bot.view.listBodies(all);
  LuaSandbox::Charge(lua, kLookCost * std::ssize(all));
  for (std::uint32_t i = 0; i < all.size(); ++i) {
    const auto distance = static_cast<double>(protocol::Length(all[i].pose.centroid - bot.view.self->pose.centroid));
    if (all[i].body != bot.view.body && distance <= radius) near.push_back({distance, all[i].body, i});
  }
  // Equal distances are ordered by body number, so that a script does not depend on the order of storage.
  const auto count = std::min<std::ptrdiff_t>(std::ssize(near), most);
  std::partial_sort(near.begin(), near.begin() + count, near.end(), [](const Neighbour& a, const Neighbour& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.body < b.body;
  });

  LuaSandbox::Charge(lua, kTableCost * count);
  lua_createtable(lua, static_cast<int>(count), 0);
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const Neighbour& neighbour = near[static_cast<std::size_t>(i)];
    PushSighting(lua, bot.view, all[neighbour.index], neighbour.distance);
    lua_rawseti(lua, -2, static_cast<lua_Integer>(i) + 1);
  }
  return 1;
}

int Script::AnswerEvents(lua_State* lua) {
  Bot& bot = SelfOf(lua);
  lua_newtable(lua);
  if (bot.view.events == nullptr) return 1;
  LuaSandbox::Charge(lua, kTableCost * std::ssize(*bot.view.events));
  for (lua_Integer i = 1; !bot.view.events->empty(); ++i) {
    const client::Client::Event& event = bot.view.events->front();
    lua_createtable(lua, 0, 4);
    lua_pushstring(lua, Name(event.kind));
    lua_setfield(lua, -2, "kind");
    if (event.body != 0) SetBody(lua, event.body);
    if (!event.name.empty()) {
      lua_pushlstring(lua, event.name.data(), event.name.size());
      lua_setfield(lua, -2, "name");
    }
    // A goal and the crown are about who has them, not about the ball or the crown.
    const bool isOfClient = event.kind == wire::EventKind::Goal || event.kind == wire::EventKind::Crown;
    lua_pushboolean(lua, isOfClient ? event.clientId != 0 && event.clientId == bot.view.client
                                    : event.body != 0 && event.body == bot.view.body);
    lua_setfield(lua, -2, "own");
    lua_rawseti(lua, -2, i);
    bot.view.events->pop_front();
  }
  return 1;
}

int Script::AnswerId(lua_State* lua) {
  lua_pushinteger(lua, static_cast<lua_Integer>(SelfOf(lua).caller.number));
  return 1;
}

}  // namespace wobble::bots
