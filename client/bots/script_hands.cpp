// The methods of `bot` that act on other bodies, and what it knows of the game. A hand holds until the script opens it;
// pushes, cuts and builds go to the server once.
//
// A hand needs a vertex. Most bots decode no shapes, so it is found in the body's rest shape at its newest pose: a body
// that is pressed flat is missed by as much as it is.
#include <algorithm>
#include <cmath>
#include <limits>
#include <lua.hpp>
#include <utility>

#include "client/bots/script.h"

namespace wobble::bots {
namespace {

// Instructions charged: for the rest shape that is gone through for a vertex, and for a table.
constexpr std::int64_t kVertexCost = 1000;
constexpr std::int64_t kGameTableCost = 50;

constexpr double kFarthestPlace = 8192;  // m, along each axis: the border of the world

float CheckPlace(lua_State* lua, int index) {
  const double value = luaL_checknumber(lua, index);
  luaL_argcheck(lua, std::abs(value) <= kFarthestPlace, index, "must be a number of -8192 to 8192");
  return static_cast<float>(value);
}

protocol::Vector3 CheckVector(lua_State* lua, int index) {
  return {CheckPlace(lua, index), CheckPlace(lua, index + 1), CheckPlace(lua, index + 2)};
}

std::uint32_t CheckBody(lua_State* lua, int index) {
  const lua_Integer body = luaL_checkinteger(lua, index);
  luaL_argcheck(lua, body >= 1 && body <= std::numeric_limits<std::uint32_t>::max(), index,
                "must be the number of a body, 1 or more");
  return static_cast<std::uint32_t>(body);
}

// The field of a table at `index`, or `missing` when the table has none. Raises an error that names it.
double ReadField(lua_State* lua, int index, const char* key, double low, double high, double missing) {
  const int kind = lua_getfield(lua, index, key);
  int isNumber = 0;
  const double value = kind == LUA_TNIL ? missing : lua_tonumberx(lua, -1, &isNumber);
  const bool isGood = kind == LUA_TNIL || (isNumber != 0 && value >= low && value <= high);
  if (!isGood) {
    luaL_error(lua, "bad argument #2 to 'build' (%s %s: must be a number of %f to %f)", key,
               luaL_tolstring(lua, -1, nullptr), low, high);
  }
  lua_pop(lua, 1);
  return value;
}

void SetInteger(lua_State* lua, const char* key, lua_Integer value) {
  lua_pushinteger(lua, value);
  lua_setfield(lua, -2, key);
}

void SetText(lua_State* lua, const char* key, std::string_view text) {
  lua_pushlstring(lua, text.data(), text.size());
  lua_setfield(lua, -2, key);
}

const char* Name(wire::GamePhase phase) {
  switch (phase) {
    case wire::GamePhase::Playing:
      return "playing";
    case wire::GamePhase::Won:
      return "won";
    case wire::GamePhase::Lobby:
      return "lobby";
    case wire::GamePhase::KickOff:
      return "kick-off";
    case wire::GamePhase::Golden:
      return "golden";
    case wire::GamePhase::Over:
      return "over";
  }
  return "unknown";
}

}  // namespace

void Script::AddDeed(lua_State* lua, Bot& bot, const Deed& deed) {
  if (bot.wish.deeds.size() >= kMostDeeds) {
    luaL_error(lua, "more than %d pushes, cuts and builds without a bot:wait", static_cast<int>(kMostDeeds));
  }
  bot.wish.deeds.push_back(deed);
}

// bot:grab(body), bot:grab(body, x, y, z); returns whether the body is known.
int Script::AnswerGrab(lua_State* lua) {
  Bot& bot = SelfOf(lua);
  const std::uint32_t body = CheckBody(lua, 2);
  const bool hasTarget = !lua_isnoneornil(lua, 3);
  const protocol::Vector3 given = hasTarget ? CheckVector(lua, 3) : protocol::Vector3{};
  LuaSandbox::Charge(lua, kVertexCost);
  bool isKnown = false;
  if (bot.view.self && bot.view.findVertex) {
    const protocol::Vector3 own = bot.view.self->pose.centroid;
    const bool goesOn = bot.wish.hand && bot.wish.hand->body == body;
    const auto vertex = goesOn ? std::optional(bot.wish.hand->vertex) : bot.view.findVertex(body, own);
    isKnown = vertex.has_value();
    if (isKnown) bot.wish.hand = client::Hand{.body = body, .vertex = *vertex, .target = hasTarget ? given : own};
  }
  lua_pushboolean(lua, isKnown ? 1 : 0);
  return 1;
}

int Script::AnswerRelease(lua_State* lua) {
  SelfOf(lua).wish.hand.reset();
  return 0;
}

// bot:push(body), bot:push(body, dx, dy, dz); returns whether the body is known.
int Script::AnswerPush(lua_State* lua) {
  Bot& bot = SelfOf(lua);
  const std::uint32_t body = CheckBody(lua, 2);
  const bool hasDirection = !lua_isnoneornil(lua, 3);
  Push push{.body = body, .vertex = 0, .direction = hasDirection ? CheckVector(lua, 3) : protocol::Vector3{}};
  luaL_argcheck(lua, !hasDirection || protocol::Length(push.direction) > 0, 3, "must be a direction, not 0, 0, 0");
  LuaSandbox::Charge(lua, kVertexCost);
  const auto other = bot.view.self && bot.view.findBody ? bot.view.findBody(body) : std::nullopt;
  const auto vertex =
      other && bot.view.findVertex ? bot.view.findVertex(body, bot.view.self->pose.centroid) : std::nullopt;
  const bool isKnown = vertex.has_value();
  if (isKnown) {
    push.vertex = *vertex;
    if (!hasDirection) push.direction = other->pose.centroid - bot.view.self->pose.centroid;
    if (protocol::Length(push.direction) > 0) AddDeed(lua, bot, push);
  }
  lua_pushboolean(lua, isKnown ? 1 : 0);
  return 1;
}

// bot:cut(body, x, y, z, x, y, z): through the triangle of the own centre and two points.
int Script::AnswerCut(lua_State* lua) {
  Bot& bot = SelfOf(lua);
  Cut cut{.body = CheckBody(lua, 2), .eye = {}, .from = CheckVector(lua, 3), .to = CheckVector(lua, 6)};
  if (!bot.view.self) return 0;
  cut.eye = bot.view.self->pose.centroid;
  AddDeed(lua, bot, cut);
  return 0;
}

// bot:build(kind, {fields}), as messages.fbs has them.
int Script::AnswerBuild(lua_State* lua) {
  using Kind = wire::BuildKind;
  static constexpr std::pair<const char*, Kind> kKinds[] = {
      {"add_particle", Kind::AddParticle},       {"add_spring", Kind::AddSpring},
      {"set_particle", Kind::SetParticle},       {"set_spring", Kind::SetSpring},
      {"remove_particle", Kind::RemoveParticle}, {"remove_spring", Kind::RemoveSpring}};
  Bot& bot = SelfOf(lua);
  const std::string_view word = luaL_checkstring(lua, 2);
  const auto* kind = std::ranges::find_if(kKinds, [&](const auto& each) { return word == each.first; });
  luaL_argcheck(lua, kind != std::end(kKinds), 2,
                "must be add_particle, add_spring, set_particle, set_spring, remove_particle or remove_spring");
  luaL_checktype(lua, 3, LUA_TTABLE);
  const auto number = [&](const char* key) { return static_cast<std::uint16_t>(ReadField(lua, 3, key, 0, 65535, 0)); };
  const auto read = [&](const char* key, double low, double high, double missing) {
    return static_cast<float>(ReadField(lua, 3, key, low, high, missing));
  };
  protocol::BuildFields fields{.kind = kind->second, .a = number("a"), .b = number("b")};
  fields.at = {read("x", -kFarthestPlace, kFarthestPlace, 0), read("y", -kFarthestPlace, kFarthestPlace, 0),
               read("z", -kFarthestPlace, kFarthestPlace, 0)};
  fields.mass = read("mass", 0, 1e6, 1);
  fields.stiffness = read("stiffness", 0, 1e6, 100);
  fields.damping = read("damping", 0, 1e6, 1);
  fields.restLength = read("length", 0, 1e4, 0);
  lua_getfield(lua, 3, "fixed");
  fields.fixed = lua_toboolean(lua, -1) != 0;
  lua_pop(lua, 1);
  AddDeed(lua, bot, fields);
  return 0;
}

// Pushes the list of players, the best first.
void Script::PushPlayers(lua_State* lua, const View& view) {
  const client::Scoreboard& board = *view.scoreboard;
  LuaSandbox::Charge(lua, kGameTableCost * std::ssize(board.scores));
  lua_createtable(lua, static_cast<int>(board.scores.size()), 0);
  for (std::size_t i = 0; i < board.scores.size(); ++i) {
    const wire::Score& score = board.scores[i];
    lua_createtable(lua, 0, 6);
    SetInteger(lua, "points", score.points());
    SetInteger(lua, "rounds", score.rounds());
    if (i < board.seats.size() && board.seats[i].side() != 0) SetInteger(lua, "side", board.seats[i].side());
    lua_pushboolean(lua, score.client_id() == view.client ? 1 : 0);
    lua_setfield(lua, -2, "own");
    const auto body = view.bodies != nullptr ? view.bodies->find(score.client_id()) : decltype(view.bodies->end()){};
    if (view.bodies != nullptr && body != view.bodies->end()) {
      SetInteger(lua, "body", body->second);
      const auto name = view.names != nullptr ? view.names->find(body->second) : decltype(view.names->end()){};
      if (view.names != nullptr && name != view.names->end()) SetText(lua, "name", name->second);
    }
    lua_rawseti(lua, -2, static_cast<lua_Integer>(i) + 1);
  }
}

int Script::AnswerGame(lua_State* lua) {
  const View& view = SelfOf(lua).view;
  if (view.game.empty() || view.scoreboard == nullptr) {
    lua_pushnil(lua);
    return 1;
  }
  const client::Scoreboard& board = *view.scoreboard;
  LuaSandbox::Charge(lua, 4 * kGameTableCost);
  lua_createtable(lua, 0, 14);
  SetText(lua, "kind", view.game);
  SetText(lua, "phase", Name(board.phase));
  SetInteger(lua, "round", board.round);
  SetInteger(lua, "rounds", board.rounds);
  SetInteger(lua, "seconds_left", board.secondsLeft);
  SetInteger(lua, "points_to_win", board.pointsToWin);
  const auto isOwn = [&](const wire::Score& score) { return score.client_id() == view.client; };
  const auto own = std::ranges::find_if(board.scores, isOwn);
  if (own != board.scores.end()) {
    const auto place = static_cast<std::size_t>(own - board.scores.begin());
    SetInteger(lua, "points", own->points());
    if (place < board.seats.size() && board.seats[place].side() != 0)
      SetInteger(lua, "side", board.seats[place].side());
  }
  if (!board.sides.empty()) {
    lua_createtable(lua, static_cast<int>(board.sides.size()), 0);
    for (std::size_t i = 0; i < board.sides.size(); ++i) {
      lua_createtable(lua, 0, 2);
      SetInteger(lua, "points", board.sides[i].points());
      SetInteger(lua, "rounds", board.sides[i].rounds());
      lua_rawseti(lua, -2, static_cast<lua_Integer>(i) + 1);
    }
    lua_setfield(lua, -2, "sides");
  }
  PushPlayers(lua, view);
  lua_setfield(lua, -2, "players");
  const auto object = board.object != 0 && view.self && view.findBody ? view.findBody(board.object) : std::nullopt;
  if (object) {
    PushSighting(lua, view, *object,
                 static_cast<double>(protocol::Length(object->pose.centroid - view.self->pose.centroid)));
    lua_setfield(lua, -2, "object");
  }
  if (board.bearer != 0 && view.bodies != nullptr) {
    const auto bearer = view.bodies->find(board.bearer);
    if (bearer != view.bodies->end()) SetInteger(lua, "bearer", bearer->second);
  }
  return 1;
}

}  // namespace wobble::bots
