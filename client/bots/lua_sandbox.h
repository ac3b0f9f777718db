// A Lua state in which a script can compute and nothing else: no files, no processes, no loading of code, no chance but
// the seed's, no call without an end and no memory without a bound.
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
  // Instructions a call may run before it is stopped; what C does for it in one call is counted as if Lua did it. Bytes
  // that one string or table may take, and all scripts together.
  static constexpr int kCallBudget = 100'000;
  static constexpr std::size_t kMaxBlockBytes = std::size_t{4} << 20;
  static constexpr std::size_t kMaxMemoryBytes = std::size_t{256} << 20;

  // Whose call it is: print and math.random answer for him. number 0: nobody's, the script is being loaded.
  struct Caller {
    unsigned number = 0;
    protocol::Random random{0};  // MakeCaller seeds it
  };
  using Log = std::function<void(unsigned caller, std::string_view text)>;

  // State() is nullptr when there is no memory for one.
  LuaSandbox(std::uint64_t seed, Log log);
  ~LuaSandbox();
  LuaSandbox(const LuaSandbox&) = delete;
  LuaSandbox& operator=(const LuaSandbox&) = delete;

  [[nodiscard]] lua_State* State() const { return m_state; }
  [[nodiscard]] Caller MakeCaller(unsigned number) const;

  // To be said before every call into the state: who is it, and his budget is full again. `caller` must outlive the
  // call.
  void BeginCall(Caller& caller);

  // To be said after a call has failed: what it held is given back if there is much of it. Lua's string buffers do not
  // try a collection before they say that memory is out, so the next caller would fail for this one.
  void FreeUnused();

  // Takes from the running call's budget what a C function is about to do for it, instructions; raises the error of an
  // endless loop when that is more than is left.
  static void Charge(lua_State* lua, std::int64_t instructions);

  // math.random's three forms, from the caller's own generator; bot:random is the same.
  static int AnswerRandom(lua_State* lua);

 private:
  static LuaSandbox& Of(lua_State* lua);
  static void* Allocate(void* sandbox, void* block, std::size_t oldBytes, std::size_t newBytes);
  static void CountInstructions(lua_State* lua, lua_Debug* where);
  static int CallCharged(lua_State* lua);
  static int AnswerPrint(lua_State* lua);
  static int AnswerSetMetatable(lua_State* lua);
  static int OpenLibraries(lua_State* lua);
  static void ChargeFunctions(lua_State* lua);

  std::uint64_t m_seed;
  Log m_log;
  std::size_t m_bytes = 0;
  std::int64_t m_budget = kCallBudget;
  Caller m_nobody;
  Caller* m_caller = &m_nobody;
  lua_State* m_state = nullptr;
};

}  // namespace wobble::bots
