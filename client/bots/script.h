// The Lua script of the bots: its run(bot) is one coroutine per bot, resumed once a round. LUA.md documents it for
// authors of scripts.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <variant>
#include <vector>

#include "client/bots/lua_sandbox.h"
#include "client/client.h"

namespace wobble::bots {

class Script {
 public:
  // Rounds that one bot:jump() stays pressed: enough that an input message carries it, too few for a second jump.
  static constexpr int kJumpRounds = 3;

  // Each bot's random numbers follow from the seed and the bot's number. log receives the text that scripts print.
  Script(std::uint64_t seed, LuaSandbox::Log log);
  ~Script();

  // Runs the script's top level, which must define run. On failure returns false, with one line in `error` that begins
  // with the file name and, where Lua knows it, the line number.
  [[nodiscard]] bool LoadFile(const std::string& path, std::string& error);
  // As LoadFile, from text. name: stands for the file name in messages.
  [[nodiscard]] bool Load(const std::string& source, const std::string& name, std::string& error);

  // Adds a bot and returns its number: 1, 2, ... in order of calls. Returns 0, with a line in `error`, when memory is
  // out.
  [[nodiscard]] unsigned AddBot(std::string& error);

  enum class Result {
    kRunning,
    kFinished,  // run returned; the last wish stays in force
    kFailed,    // stopped by an error, in this round or before; the input is neutral
  };
  // The state of the world that a bot can read. Pointers may be null and must be valid during the call only.
  struct View {
    double time = 0;  // seconds since the bot first played; continues while it is away
    bool isPlaying = false;
    bool isAway = false;  // neither playing nor joining nor leaving
    // The fields below are valid while the bot plays.
    std::uint32_t body = 0;
    std::optional<client::Sighting> self;
    std::function<void(std::vector<client::Sighting>&)> listBodies;  // called only when the script asks for neighbours
    const std::unordered_map<std::uint32_t, std::string>* names = nullptr;  // of the players, by body
    std::deque<client::Client::Event>* events = nullptr;                    // emptied when the script asks for events
    std::uint32_t client = 0;
    std::string_view game;                                                     // its name; empty: the scene has none
    const client::Scoreboard* scoreboard = nullptr;                            // of the game
    const std::unordered_map<std::uint32_t, std::uint32_t>* bodies = nullptr;  // of the players, by client
    std::function<std::optional<client::Sighting>(std::uint32_t body)> findBody;
    // The vertex of the body that is nearest to the place, world, m.
    std::function<std::optional<std::uint16_t>(std::uint32_t body, const protocol::Vector3& place)> findVertex;
  };
  // What a hand holds, and what it does once.
  struct Push {
    std::uint32_t body = 0;
    std::uint16_t vertex = 0;
    protocol::Vector3 direction;
  };
  struct Cut {
    std::uint32_t body = 0;
    protocol::Vector3 eye, from, to;
  };
  using Deed = std::variant<Push, Cut, protocol::BuildFields>;
  // Deeds between two waits: more than a hand can do.
  static constexpr std::size_t kMostDeeds = 8;
  // The input and the presence that a bot asks for until the next round.
  struct Wish {
    client::Input input;
    bool play = true;  // false: leave, or stay away
    std::optional<client::Hand> hand = {};
    std::vector<Deed> deeds = {};  // each is there in one round alone
  };
  // Runs one round of one bot; while the bot waits, only repeats the wish. The round in which an error occurs sets
  // `error` to one line; later rounds do not.
  [[nodiscard]] Result Resume(unsigned number, const View& view, Wish& wish, std::string& error);

 private:
  // The condition that a yielded coroutine waits for.
  enum class Awaited { kTime, kPlaying, kAway };
  struct Bot {
    Script* script = nullptr;
    LuaSandbox::Caller caller;
    lua_State* thread = nullptr;
    int reference = 0;  // registry reference that keeps the thread from being collected
    Result result = Result::kRunning;
    bool started = false;  // the first resume passes the bot to run, later ones pass nothing
    Awaited awaited = Awaited::kTime;
    double wake = 0;  // View::time from which it is resumed
    int jumpRounds = 0;
    Wish wish;
    View view;

    [[nodiscard]] bool IsDue() const;
  };

  struct Neighbour {
    double distance = 0;
    std::uint32_t body = 0;
    std::uint32_t index = 0;  // index in m_sightings
  };

  void Continue(Bot& bot, std::string& error);
  static int CreateCoroutine(lua_State* lua);
  static int PrepareBots(lua_State* lua);

  // The methods of `bot`, implemented in script_methods.cpp.
  static void MakeBotType(lua_State* lua);
  static void PushBot(lua_State* lua, Bot* bot);
  static Bot& SelfOf(lua_State* lua);
  static void PushSighting(lua_State* lua, const View& view, const client::Sighting& sighting, double distance);
  static int Await(lua_State* lua, Bot& bot, Awaited awaited, const Wish& wish);
  static int AnswerMove(lua_State* lua);
  static int AnswerJump(lua_State* lua);
  static int AnswerPuff(lua_State* lua);
  static int AnswerStiffen(lua_State* lua);
  static int AnswerWait(lua_State* lua);
  static int AnswerLeave(lua_State* lua);
  static int AnswerJoin(lua_State* lua);
  static int AnswerTime(lua_State* lua);
  static int AnswerPosition(lua_State* lua);
  static int AnswerVelocity(lua_State* lua);
  static int AnswerBody(lua_State* lua);
  static int AnswerNear(lua_State* lua);
  static int AnswerEvents(lua_State* lua);
  static int AnswerId(lua_State* lua);
  // And in script_hands.cpp: what it does to other bodies, and the game.
  static int AnswerGrab(lua_State* lua);
  static int AnswerRelease(lua_State* lua);
  static int AnswerPush(lua_State* lua);
  static int AnswerCut(lua_State* lua);
  static int AnswerBuild(lua_State* lua);
  static int AnswerGame(lua_State* lua);
  static void PushPlayers(lua_State* lua, const View& view);
  static void AddDeed(lua_State* lua, Bot& bot, const Deed& deed);

  LuaSandbox m_sandbox;
  LuaSandbox::Caller m_loader;
  std::vector<std::unique_ptr<Bot>> m_bots;
  std::vector<client::Sighting> m_sightings;  // scratch
  std::vector<Neighbour> m_near;              // scratch
};

}  // namespace wobble::bots
