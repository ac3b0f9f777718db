// A bot's mind: a Lua script whose run(bot) is a coroutine, resumed once a round. LUA.md is its author's view.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "client/bots/lua_sandbox.h"
#include "client/client.h"
#include "protocol/geometry.h"

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
    kFinished,  // run returned; the last input stays
    kFailed,    // stopped by an error, now or before; the input is neutral
  };
  // What a bot can know: seconds since he began to play, and where his body is, metres.
  struct View {
    double time = 0;
    std::optional<protocol::Vector3> position;
  };
  // One round of one bot; does no more than hand out the input while he waits. The round in which an error happens
  // sets `error` to one line, later ones do not.
  [[nodiscard]] Result Resume(unsigned number, const View& view, client::Input& input, std::string& error);

 private:
  struct Bot;
  static Bot& SelfOf(lua_State* lua);
  static int CreateCoroutine(lua_State* lua);
  static int AnswerMove(lua_State* lua);
  static int AnswerJump(lua_State* lua);
  static int AnswerPuff(lua_State* lua);
  static int AnswerStiffen(lua_State* lua);
  static int AnswerWait(lua_State* lua);
  static int AnswerTime(lua_State* lua);
  static int AnswerPosition(lua_State* lua);
  static int AnswerId(lua_State* lua);
  static int PrepareBots(lua_State* lua);

  LuaSandbox m_sandbox;
  LuaSandbox::Caller m_loader;
  std::vector<std::unique_ptr<Bot>> m_bots;
};

}  // namespace wobble::bots
