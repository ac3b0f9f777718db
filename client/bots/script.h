// A bot's mind: a Lua script whose run(bot) is a coroutine, resumed once a round. LUA.md is its author's view.
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "client/bots/lua_sandbox.h"
#include "client/client.h"

namespace wobble::bots {

class Script {
 public:
  // Rounds that one bot:jump() stays pressed: long enough for an input message to carry it, short of a second jump.
  static constexpr int kJumpRounds = 3;

  // Every bot's chances follow from the seed and his number. log gets what scripts print.
  Script(std::uint64_t seed, LuaSandbox::Log log);
  ~Script();

  // Runs the script's top level, which must define run. On failure false, with one line in `error` that begins with
  // the file and, where Lua knows it, the line.
  [[nodiscard]] bool LoadFile(const std::string& path, std::string& error);
  // name: what stands for the file in messages.
  [[nodiscard]] bool Load(const std::string& source, const std::string& name, std::string& error);

  // Bots are numbered 1, 2, ... in the order they are added. 0 with a line in `error` when memory is out.
  [[nodiscard]] unsigned AddBot(std::string& error);

  enum class Result {
    kRunning,
    kFinished,  // run returned; the last wish stays
    kFailed,    // stopped by an error, now or before; the input is neutral
  };
  // What a bot can know. Pointers may be null, and need to live for the call only.
  struct View {
    double time = 0;  // seconds since he first played; goes on while he is away
    bool isPlaying = false;
    bool isAway = false;  // neither playing nor on his way in or out
    // The rest while he plays.
    std::uint32_t body = 0;
    std::optional<client::Sighting> self;
    std::function<void(std::vector<client::Sighting>&)> listBodies;         // called only when the script looks round
    const std::unordered_map<std::uint32_t, std::string>* names = nullptr;  // of players, by body
    std::deque<client::Client::Event>* events = nullptr;                    // emptied when the script asks for them
  };
  // What he asks for until the next round.
  struct Wish {
    client::Input input;
    bool play = true;  // false: to leave, or to stay away
  };
  // One round of one bot; does no more than repeat the wish while he waits. The round in which an error happens sets
  // `error` to one line, later ones do not.
  [[nodiscard]] Result Resume(unsigned number, const View& view, Wish& wish, std::string& error);

 private:
  // What a coroutine that has yielded waits for.
  enum class Awaited { kTime, kPlaying, kAway };
  struct Bot {
    Script* script = nullptr;
    LuaSandbox::Caller caller;
    lua_State* thread = nullptr;
    int reference = 0;  // keeps the thread from being collected
    Result result = Result::kRunning;
    bool started = false;  // the first resume passes run its bot, the others nothing
    Awaited awaited = Awaited::kTime;
    double wake = 0;  // the view's time from which it is resumed again
    int jumpRounds = 0;
    Wish wish;
    View view;

    [[nodiscard]] bool IsDue() const;
  };

  struct Neighbour {
    double distance = 0;
    std::uint32_t body = 0;
    std::uint32_t index = 0;  // in m_sightings
  };

  void Continue(Bot& bot, std::string& error);
  static int CreateCoroutine(lua_State* lua);
  static int PrepareBots(lua_State* lua);

  // What `bot:...` does: script_methods.cpp.
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

  LuaSandbox m_sandbox;
  LuaSandbox::Caller m_loader;
  std::vector<std::unique_ptr<Bot>> m_bots;
  std::vector<client::Sighting> m_sightings;  // scratch
  std::vector<Neighbour> m_near;              // scratch
};

}  // namespace wobble::bots
