// What a bot's script can do, what it cannot do, and that an error affects its own bot only.
#include "client/bots/script.h"

#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <numbers>

namespace wobble::bots {
namespace {

struct Line {
  unsigned bot;
  std::string text;
};

// A script with its bots and everything it printed.
class Stage {
 public:
  explicit Stage(const std::string& source, unsigned bots = 1, std::uint64_t seed = 1)
      : m_script(seed, [this](unsigned bot, std::string_view text) {
          lines.push_back({bot, std::string(text)});
        }) {
    loaded = m_script.Load(source, "test.lua", error);
    for (unsigned i = 0; loaded && i < bots; ++i) EXPECT_EQ(m_script.AddBot(error), i + 1) << error;
  }

  Script::Result Resume(unsigned bot, double time) {
    Script::View view;
    view.time = time;
    view.isPlaying = true;
    if (position) view.self = client::Sighting{1, {*position, {}}, std::nullopt, 0};
    Script::Wish wish;
    const Script::Result result = m_script.Resume(bot, view, wish, error);
    EXPECT_TRUE(wish.play);
    input = wish.input;
    return result;
  }

  bool loaded = false;
  std::string error;
  std::vector<Line> lines;
  client::Input input;
  std::optional<protocol::Vector3> position;

 private:
  Script m_script;
};

// Loads a script that must be rejected, and returns the error.
std::string Refuse(const std::string& source) {
  const Stage stage(source);
  EXPECT_FALSE(stage.loaded) << source;
  EXPECT_EQ(stage.error.find('\n'), std::string::npos);
  return stage.error;
}

TEST(BotScript, AsksForInputAndKnowsItsBody) {
  Stage stage(R"(
    function run(bot)
      assert(bot:position() == nil)
      bot:move(0.5, -7) bot:puff(true) bot:jump()
      bot:wait(0)
      local x, y, z = bot:position()
      print(bot:id(), bot:time(), x, y, z)
      bot:puff(false) bot:stiffen(true)
    end)");
  ASSERT_TRUE(stage.loaded) << stage.error;
  EXPECT_EQ(stage.Resume(1, 0), Script::Result::kRunning) << stage.error;
  EXPECT_FLOAT_EQ(stage.input.moveX, 0.5F);
  EXPECT_FLOAT_EQ(stage.input.moveY, -1);
  EXPECT_TRUE(stage.input.puff && stage.input.jump && !stage.input.stiffen);
  stage.position = protocol::Vector3{1, 2, 3};
  EXPECT_EQ(stage.Resume(1, 0.25), Script::Result::kFinished) << stage.error;
  ASSERT_EQ(stage.lines.size(), 1U);
  EXPECT_EQ(stage.lines[0].bot, 1U);
  EXPECT_EQ(stage.lines[0].text, "1\t0.25\t1.0\t2.0\t3.0");
  EXPECT_TRUE(!stage.input.puff && stage.input.jump && stage.input.stiffen);
  // Jump ends by itself, all other input stays after the script's end.
  for (int i = 2; i < 2 + Script::kJumpRounds; ++i) EXPECT_EQ(stage.Resume(1, 0.25 * i), Script::Result::kFinished);
  EXPECT_FALSE(stage.input.jump);
  EXPECT_FLOAT_EQ(stage.input.moveX, 0.5F);
}

TEST(BotScript, WaitsToTheRound) {
  Stage stage("function run(bot) while true do print(bot:time()) bot:wait(0.5) end end");
  ASSERT_TRUE(stage.loaded) << stage.error;
  std::vector<int> rounds;
  for (int round = 0; round < 200; ++round) {
    const std::size_t before = stage.lines.size();
    ASSERT_EQ(stage.Resume(1, round / 60.0), Script::Result::kRunning) << stage.error;
    if (stage.lines.size() > before) rounds.push_back(round);
  }
  EXPECT_EQ(rounds, (std::vector<int>{0, 30, 60, 90, 120, 150, 180}));
}

TEST(BotScript, OpensNothingThatReachesOutside) {
  for (const char* name : {"os", "io", "debug", "package", "require", "load", "loadfile", "dofile", "loadstring",
                           "collectgarbage", "warn", "xpcall", "math.randomseed"}) {
    const Stage stage("assert(" + std::string(name) + " == nil) function run(bot) end");
    EXPECT_TRUE(stage.loaded) << name << ": " << stage.error;
  }
  const Stage stage(
      "assert(math.floor and string.format and table.sort and coroutine.wrap and pcall and pairs) "
      "function run(bot) end");
  EXPECT_TRUE(stage.loaded) << stage.error;
  EXPECT_NE(Refuse("setmetatable({}, {__gc = function() while true do end end})").find("__gc"), std::string::npos);
  EXPECT_NE(Refuse("\x1bLua").find("binary chunk"), std::string::npos);
}

TEST(BotScript, FileThatDoesNotLoadIsNamedWithItsLine) {
  EXPECT_EQ(Refuse("function run(bot)\n  local = 3\nend").find("test.lua:2: "), 0U);
  EXPECT_EQ(Refuse("function run(bot)\n\n").find("test.lua:3: "), 0U);
  EXPECT_EQ(Refuse("local x = nil\nx.y = 3\nfunction run(bot) end").find("test.lua:2: "), 0U);
  EXPECT_EQ(Refuse("error('no\\nplace', 0)"), "test.lua: no place");
  EXPECT_EQ(Refuse("error({})"), "test.lua: error value is a table, not a text");
  EXPECT_EQ(Refuse("x = 'not closed\n").find("test.lua:1: unfinished string"), 0U);
  EXPECT_EQ(Refuse("function walk(bot) end"), "test.lua: defines no function run(bot)");
  EXPECT_EQ(Refuse("setmetatable(_G, {__index = function() return print end})"),
            "test.lua: defines no function run(bot)");
  EXPECT_EQ(Refuse("while true do end").find("test.lua:1: stopped after"), 0U);

  Script script(1, {});
  std::string error;
  EXPECT_FALSE(script.LoadFile("no/such/file.lua", error));
  EXPECT_EQ(error, "no/such/file.lua: cannot be read: No such file or directory");
}

TEST(BotScript, EndlessLoopStopsOneBotAndNamesTheLine) {
  Stage stage(R"(
function run(bot)
  bot:move(1, 1)
  bot:jump()
  while bot:id() == 1 do
    local x = 1
  end
  while true do
    print('on')
    bot:wait(0)
  end
end)",
              2);
  ASSERT_TRUE(stage.loaded) << stage.error;
  EXPECT_EQ(stage.Resume(1, 0), Script::Result::kFailed);
  EXPECT_TRUE(stage.error.starts_with("test.lua:5: stopped after") ||
              stage.error.starts_with("test.lua:6: stopped after"))
      << stage.error;
  EXPECT_EQ(stage.input.moveX, 0);  // its input is neutral
  EXPECT_FALSE(stage.input.jump);
  stage.error.clear();
  for (int round = 0; round < 100; ++round) {
    EXPECT_EQ(stage.Resume(1, round / 60.0), Script::Result::kFailed);
    EXPECT_EQ(stage.Resume(2, round / 60.0), Script::Result::kRunning);
  }
  EXPECT_EQ(stage.error, "");  // reported once
  EXPECT_EQ(stage.lines.size(), 100U);
  EXPECT_EQ(stage.lines.back().bot, 2U);
}

TEST(BotScript, NoEndlessLoopOutwitsTheBudget) {
  const auto begin = std::chrono::steady_clock::now();
  for (const char* body : {
           "while true do pcall(function() while true do end end) end",
           "while true do pcall(pcall, pcall, function() while true do end end) end",
           "while true do coroutine.resume(coroutine.create(function() while true do end end)) end",
           "local function deep() coroutine.wrap(function() deep() while true do end end)() end deep() while true do "
           "end",
           "local function again() return again() end again()",
           "local t = setmetatable({}, {__index = function(t, k) while true do end end}) return t.x",
           "while true do local _ <close> = setmetatable({}, {__close = function() while true do end end}) end",
       }) {
    Stage stage("function run(bot) " + std::string(body) + " end");
    ASSERT_TRUE(stage.loaded) << stage.error;
    EXPECT_EQ(stage.Resume(1, 0), Script::Result::kFailed) << body;
    EXPECT_NE(stage.error.find("test.lua:1: "), std::string::npos) << stage.error;
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
}

TEST(BotScript, BudgetIsFullAgainAfterEveryWait) {
  Stage stage("function run(bot) while true do for i = 1, 30000 do local x = i end bot:wait(0) end end");
  ASSERT_TRUE(stage.loaded) << stage.error;
  for (int round = 0; round < 50; ++round) {
    ASSERT_EQ(stage.Resume(1, round), Script::Result::kRunning) << stage.error;
  }
}

TEST(BotScript, MemoryIsBounded) {
  Stage stage(
      "function run(bot) local t = {} while true do "
      "for i = 1, 70 do t[#t + 1] = string.rep('x', 16000) end bot:wait(0) end end",
      2);
  ASSERT_TRUE(stage.loaded) << stage.error;
  Script::Result result = Script::Result::kRunning;
  for (int round = 0; round < 256 && result == Script::Result::kRunning; ++round) result = stage.Resume(1, round);
  EXPECT_EQ(result, Script::Result::kFailed);
  EXPECT_NE(stage.error.find("not enough memory"), std::string::npos) << stage.error;
  EXPECT_EQ(stage.Resume(2, 0), Script::Result::kRunning) << stage.error;  // the memory of bot 1 has been freed
}

TEST(BotScript, NoSingleStringOrTableIsLarge) {
  for (const char* body : {"local s = 'x' while true do s = s .. s bot:wait(0) end",
                           "local t = {} while true do for i = 1, 8000 do t[#t + 1] = i end bot:wait(0) end"}) {
    Stage stage("function run(bot) " + std::string(body) + " end");
    ASSERT_TRUE(stage.loaded) << stage.error;
    Script::Result result = Script::Result::kRunning;
    for (int round = 0; round < 100 && result == Script::Result::kRunning; ++round) result = stage.Resume(1, round);
    EXPECT_EQ(result, Script::Result::kFailed) << body;
    EXPECT_EQ(stage.error, "test.lua:1: not enough memory") << body;
  }
}

// Each of these calls took from seconds to years in C code, where no hook counts instructions.
TEST(BotScript, NoSlowCallOutwitsTheBudget) {
  const auto begin = std::chrono::steady_clock::now();
  for (const char* body : {
           "local s = ('a'):rep(2000) return s:match('.-.-.-.-b')",
           "local s = ('a'):rep(2000) return s:find('a*a*a*a*b')",
           "local s = ('a'):rep(2000) return s:gsub('a?a?a?a?a?b', '')",
           "for _ in (('a'):rep(2000)):gmatch('^.-.-.-.-b') do end",
           "while true do pcall(string.find, ('a'):rep(300), '.-.-b') end",
           "while true do local s = ('x'):rep(1 << 13) end",
           "while true do local s = ('x'):rep(1 << 60, '') end",
           "local s = ('x'):rep(1 << 13) while true do local t = s .. 'y' end",
           "local t = {} for i = 1, 8000 do t[i] = -i end while true do table.sort(t) end",
           "local t = {} for i = 1, 8000 do t[i] = '' end while true do table.concat(t) end",
           "local t = {} for i = 1, 8000 do t[i] = i end while true do table.insert(t, 1, i) end",
           "local t = setmetatable({}, {__len = function() return 1 << 40 end}) table.insert(t, 1, 1)",
           "table.move({}, 1, 1 << 50, 2)",
           "while true do local t = {table.unpack({}, 1, 1 << 18)} end",
       }) {
    Stage stage("function run(bot) " + std::string(body) + " end");
    ASSERT_TRUE(stage.loaded) << stage.error;
    EXPECT_EQ(stage.Resume(1, 0), Script::Result::kFailed) << body;
    EXPECT_EQ(stage.error.find("test.lua:1: stopped"), 0U) << body << " gave " << stage.error;
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(20));
}

// Arguments for which a call was charged less than it does: empty strings, numbers that become strings, lengths that
// change, replacements that add nothing, values that the metatable of strings makes pass for tables. Each took from
// seconds to years. The bound is for sanitizers; the longest takes a second without.
TEST(BotScript, NoArgumentsMakeASlowCallCheap) {
  const std::string liar =
      "local n = 0 local t = setmetatable({}, {__len = function() n = n + 1 "
      "return n % 2 == 0 and 1 << 40 or 0 end, __index = function() return '' end}) ";
  const std::string strings =
      "local m = getmetatable('') m.__len = function() return 1 << 40 end m.__newindex = math.type ";
  for (const std::string& body : std::vector<std::string>{
           "return string.rep('', 1 << 40, '')",
           "return string.rep('', 1 << 40)",
           "return string.rep('', 1e300)",
           "return string.rep('', 0/0)",
           "return string.find(12345678901234, ('.-'):rep(20) .. 'x')",
           "return string.match(12345678901234, ('.-'):rep(20) .. 'x')",
           "return (('x'):rep(10000)):gsub('', ('%0'):rep(5000))",
           "while true do (('x'):rep(100)):gsub('', ('%0'):rep(500)) end",
           liar + "table.insert(t, 1, 1)",
           liar + "table.remove(t, 1)",
           liar + "table.concat(t)",
           liar + "table.sort(t)",
           liar + "return table.unpack(t)",
           strings + "table.insert('x', 1, 1)",
           strings + "table.concat('x')",
           strings + "table.sort('x')",
           "while true do table.unpack('x', 1, 10000) end",
           "while true do pcall(table.unpack, 'x', 1, 60000) end",
           "local s = ('1'):rep(16000) while true do local x = tonumber(s) end",
           "local s = ('1'):rep(16000) while true do local x = s + 1 end",
           "local t = {} for i = 1, 20 do t[i] = 1e308 end local f = ('%.99f'):rep(20) "
           "while true do string.format(f, table.unpack(t)) end",
           "while true do string.format(('%%'):rep(8000)) end",
           "while true do string.pack(('i1'):rep(3), 1, 2, 3) string.packsize(('i1'):rep(5000)) end",
           "while true do pcall(string.pack, 'c1000000000', '') end",
           "while true do print(('x'):rep(16000)) end",
           "while true do print() end",
           "local t = {} for i = 1, 200 do t[i] = ('x'):rep(2000) end while true do table.sort(t) end",
           "while true do pcall(string.rep, 'x', 1 << 20) end",
           "local s = ('x'):rep(10000) while true do pcall(function() return s .. s end) end",
           "local a, b = ('x'):rep(16000), ('x'):rep(15999) .. 'x' while true do local c = a < b end",
           "local function f(...) while true do local n = select('#', ...) end end f(table.unpack({}, 1, 10000))",
           "local function f(...) while true do local n = math.max(0, ...) end end "
           "f(string.byte(('x'):rep(8000), 1, -1))",
           "local function g() end local function f(...) while true do g(...) end end f(table.unpack({}, 1, 30000))",
       }) {
    const auto begin = std::chrono::steady_clock::now();
    Stage stage("function run(bot) " + body + " end");
    ASSERT_TRUE(stage.loaded) << stage.error;
    EXPECT_EQ(stage.Resume(1, 0), Script::Result::kFailed) << body;
    EXPECT_EQ(stage.error.find("test.lua:1: stopped"), 0U) << body << " gave " << stage.error;
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
    EXPECT_LT(took.count(), 10) << body;
  }
}

TEST(BotScript, EverydayUseOfTheLibrariesIsCheap) {
  Stage stage(R"(
    function run(bot)
      local names = {}
      for i = 1, 500 do
        names[#names + 1] = string.format('%s %d', 'bot', i)
        assert(tonumber(names[i]:match('^bot (%d+)$')) == i)
        assert(names[i]:find('bot', 1, true) == 1 and names[i]:upper():sub(1, 3) == 'BOT')
      end
      bot:wait(0)
      assert(#(' '):rep(100):match('^%s*(.-)%s*$') == 0)  -- as LUA.md promises
      bot:wait(0)
      assert(('a'):rep(1000):find('b+') == nil)
      bot:wait(0)
      table.sort(names, function(a, b) return a > b end)
      assert(#table.concat(names, ', ') > 3000 and select('#', table.unpack(names)) == 500)
      assert(names[1] == 'bot 99' and table.remove(names) == 'bot 1' and table.remove(names, 1) == 'bot 99')
      bot:wait(0)
      assert(('a b c'):gsub(' ', '--') == 'a--b--c' and '10' + 1 == 11 and #('='):rep(16000) == 16000)
      assert(tonumber('12') == 12 and select('#', 1, 2) == 2 and math.max(1, 3, 2) == 3)
    end)");
  ASSERT_TRUE(stage.loaded) << stage.error;
  for (int call = 0; call < 4; ++call) EXPECT_EQ(stage.Resume(1, 0), Script::Result::kRunning) << stage.error;
  EXPECT_EQ(stage.Resume(1, 0), Script::Result::kFinished) << stage.error;
}

TEST(BotScript, RuntimeErrorsNameTheirLine) {
  for (const char* statement : {"local x = nil + 1",
                                "error('no place', 0)",
                                "error({})",
                                "bot:move(1)",
                                "bot:move(0/0, 1)",
                                "bot:puff(1)",
                                "bot:wait(-1)",
                                "bot:wait('long')",
                                "bot:fly()",
                                "bot.wait()",
                                "bot.wait(3)",
                                "math.random(2, 1)",
                                "coroutine.wrap(function() bot:wait(1) end)()",
                                "getmetatable(bot).__index = nil",
                                "setmetatable(bot, nil)",
                                "coroutine.close(coroutine.running())",
                                "bot:near(-1)",
                                "bot:near(1, 0)",
                                "bot:near('far')",
                                "coroutine.wrap(function() bot:leave() end)()",
                                "string.rep()",
                                "local s = ('x'):rep('many')",
                                "table.concat(nil)",
                                "table.concat()",
                                "table.sort(1)",
                                "tonumber()",
                                "math.max()",
                                "local s = 'x' + 1",
                                "local s = ('x'):find()"}) {
    Stage stage("function run(bot)\n bot:wait(0)\n " + std::string(statement) + "\n bot:wait(0)\nend");
    ASSERT_TRUE(stage.loaded) << stage.error;
    EXPECT_EQ(stage.Resume(1, 0), Script::Result::kRunning) << stage.error;
    EXPECT_EQ(stage.Resume(1, 1), Script::Result::kFailed) << statement;
    EXPECT_EQ(stage.error.find("test.lua:3: "), 0U) << statement << " gave " << stage.error;
  }
}

TEST(BotScript, ABotsThreadInAnothersHandsHarmsOnlyThem) {
  Stage stage(R"(
    local threads = {}
    function run(bot)
      threads[bot:id()] = coroutine.running()
      bot:wait(0)
      if bot:id() == 1 then coroutine.close(threads[2]) end
      bot:wait(0)
      print(bot:id())
    end)",
              3);
  ASSERT_TRUE(stage.loaded) << stage.error;
  for (int round = 0; round < 4; ++round) {
    for (unsigned bot = 1; bot <= 3; ++bot) {
      const Script::Result result = stage.Resume(bot, round);
      if (round < 3) continue;
      EXPECT_EQ(result, bot == 2 ? Script::Result::kFailed : Script::Result::kFinished) << stage.error;
    }
  }
  EXPECT_EQ(stage.lines.size(), 2U);
}

TEST(BotScript, ChanceRepeatsWithTheSeedAndDiffersBetweenBots) {
  const std::string source =
      "function run(bot) while true do print(math.random(1000000), bot:random()) bot:wait(0) end end";
  const auto play = [&](std::uint64_t seed) {
    Stage stage(source, 2, seed);
    for (int round = 0; round < 20; ++round) {
      EXPECT_EQ(stage.Resume(1 + round % 2, round), Script::Result::kRunning) << stage.error;
    }
    std::string text;
    for (const Line& line : stage.lines) text += line.text + "\n";
    EXPECT_NE(stage.lines.at(0).text, stage.lines.at(1).text);
    return text;
  };
  EXPECT_EQ(play(5), play(5));
  EXPECT_NE(play(5), play(6));

  // The random numbers of one bot do not depend on the number of bots, nor on the numbers that others draw.
  Stage alone(source, 1, 5);
  Stage among(source, 3, 5);
  for (int round = 0; round < 10; ++round) {
    EXPECT_EQ(alone.Resume(1, round), Script::Result::kRunning);
    EXPECT_EQ(among.Resume(3, round), Script::Result::kRunning);
    EXPECT_EQ(among.Resume(1, round), Script::Result::kRunning);
    EXPECT_EQ(among.lines.back().text, alone.lines.back().text);
  }
}

TEST(BotScript, ChanceIsEven) {
  Stage stage(R"(
    local count = {0, 0, 0, 0, 0, 0}
    function run(bot)
      for i = 1, 6000 do local n = math.random(6) count[n] = count[n] + 1 end
      for n = 1, 6 do assert(count[n] > 850 and count[n] < 1150, count[n]) end
      local low, high = math.random(math.mininteger, math.maxinteger), bot:random(-3, -3)
      assert(math.type(low) == 'integer' and high == -3)
      bot:wait(0)
      for i = 1, 3000 do local u = bot:random() assert(u >= 0 and u < 1) end
    end)");
  ASSERT_TRUE(stage.loaded) << stage.error;
  EXPECT_EQ(stage.Resume(1, 0), Script::Result::kRunning) << stage.error;
  EXPECT_EQ(stage.Resume(1, 1), Script::Result::kFinished) << stage.error;
}

}  // namespace
}  // namespace wobble::bots
