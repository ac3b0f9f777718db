// A Lua state in which a script can only compute: no files, no processes, no loading of code, random numbers from the
// seed alone, a bound on the instructions of a call and on memory.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string_view>

#include "protocol/random.h"

struct lua_Debug;
struct lua_State;

namespace wobble::bots {

class LuaSandbox {
 public:
  // kCallBudget: Lua instructions a call may run before it is stopped; the work of C functions is charged as well.
  // kMaxStringBytes: of one string. kMaxBlockBytes: of one table. kMaxMemoryBytes: of all scripts together.
  static constexpr int kCallBudget = 100'000;
  static constexpr std::size_t kMaxStringBytes = std::size_t{16} << 10;
  static constexpr std::size_t kMaxBlockBytes = std::size_t{1} << 20;
  static constexpr std::size_t kMaxMemoryBytes = std::size_t{256} << 20;

  // The bot that a call belongs to: print and math.random answer for this bot. number 0: no bot, the script is being
  // loaded.
  struct Caller {
    unsigned number = 0;
    protocol::Random random{0};  // seeded by MakeCaller
  };
  using Log = std::function<void(unsigned caller, std::string_view text)>;

  // After a failed allocation State() is nullptr. log receives the text that scripts print, with the caller's number.
  LuaSandbox(std::uint64_t seed, Log log);
  ~LuaSandbox();
  LuaSandbox(const LuaSandbox&) = delete;
  LuaSandbox& operator=(const LuaSandbox&) = delete;

  [[nodiscard]] lua_State* State() const { return m_state; }
  [[nodiscard]] Caller MakeCaller(unsigned number) const;

  // Refills the instruction budget and sets the caller. Must precede every call into the state. `caller` must outlive
  // the call.
  void BeginCall(Caller& caller);

  // Collects garbage when there is much of it. Must follow a call that failed: Lua's string buffers do not try a
  // collection before they report that memory is out, so without this the next caller would fail in place of this one.
  void FreeUnused();

  // Charges the running call's budget with `instructions`, before a C function does that work. Raises the Lua error of
  // an endless loop when more than the rest of the budget is charged.
  static void Charge(lua_State* lua, std::int64_t instructions);

  // Implements the three forms of math.random from the caller's own generator, and bot:random as well.
  static int AnswerRandom(lua_State* lua);

 private:
  static LuaSandbox& Of(lua_State* lua);
  static void* Allocate(void* sandbox, void* block, std::size_t oldBytes, std::size_t newBytes);
  static void CountInstructions(lua_State* lua, lua_Debug* where);
  static int CallCharged(lua_State* lua);
  static int AnswerPrint(lua_State* lua);
  static int AnswerSetMetatable(lua_State* lua);
  static int OpenLibraries(lua_State* lua);
  static void ChargeFunction(lua_State* lua, const char* library, const char* name);
  static void ChargeFunctions(lua_State* lua, const char* library);

  std::uint64_t m_seed;
  Log m_log;
  std::size_t m_bytes = 0;
  std::int64_t m_budget = kCallBudget;
  Caller m_nobody;
  Caller* m_caller = &m_nobody;
  lua_State* m_state = nullptr;
};

}  // namespace wobble::bots
