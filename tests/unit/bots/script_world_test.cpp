// What a bot's script reads of the world: its own body and those near it, their names, events, and its own absence.
#include <gtest/gtest.h>

#include "client/bots/lua_costs.h"
#include "client/bots/script.h"
#include "tests/support/places.h"

namespace wobble::bots {
namespace {

// One bot and the world around it.
class World {
 public:
  explicit World(const std::string& source)
      : m_script(1, [this](unsigned, std::string_view text) { printed.append(text).append("\n"); }) {
    EXPECT_TRUE(m_script.Load(source, "test.lua", error)) << error;
    EXPECT_EQ(m_script.AddBot(error), 1U) << error;
    view.isPlaying = true;
    view.body = 7;
    view.names = &names;
    view.events = &events;
    view.listBodies = [this](std::vector<client::Sighting>& sightings) {
      ++looks;
      sightings = bodies;
    };
    AddBody(7, {1, 1, 0});
    view.self = bodies[0];
  }
  void AddBody(std::uint32_t body, protocol::Vector3 place, std::optional<protocol::Vector3> velocity = std::nullopt) {
    bodies.push_back({body, {place, {}}, velocity, 0.5});
  }
  Script::Result Resume(double time) {
    view.time = time;
    return m_script.Resume(1, view, wish, error);
  }

  Script::View view;
  Script::Wish wish;
  std::vector<client::Sighting> bodies;
  std::unordered_map<std::uint32_t, std::string> names;
  std::deque<client::Client::Event> events;
  unsigned looks = 0;
  std::string printed;
  std::string error;

 private:
  Script m_script;
};

TEST(BotScriptWorld, NearListsBodiesByDistance) {
  World world(R"(function run(bot)
    for i, b in ipairs(bot:near(5)) do
      print(i, b.body, b.distance, b.x, b.y, b.z, b.vx, b.vy, b.vz, b.age, b.name)
    end
    print(#bot:near(0), #bot:near(), #bot:near(2.5), #bot:near(nil, 3), bot:near(9, 1)[1].body)
  end)");
  world.AddBody(9, {1, 5, 0}, protocol::Vector3{1, 2, 3});
  world.AddBody(8, {1, 1, 2});
  world.AddBody(6, {1, 1, -2});  // distance 8: just near enough
  world.AddBody(5, {1, 7, 0});   // too far
  world.names = {{8, "Ada"}, {5, "Bob"}};
  EXPECT_EQ(world.Resume(0), Script::Result::kFinished) << world.error;
  EXPECT_EQ(world.printed,
            "1\t6\t2.0\t1.0\t1.0\t-2.0\tnil\tnil\tnil\t0.5\tnil\n"
            "2\t8\t2.0\t1.0\t1.0\t2.0\tnil\tnil\tnil\t0.5\tAda\n"
            "3\t9\t4.0\t1.0\t5.0\t0.0\t1.0\t2.0\t3.0\t0.5\tnil\n"
            "0\t4\t2\t3\t6\n");
  EXPECT_EQ(world.looks, 6U);
}

TEST(BotScriptWorld, LooksOnlyWhenAskedAndPaysForIt) {
  World quiet("function run(bot) while true do bot:wait(0) end end");
  for (int round = 0; round < 10; ++round) EXPECT_EQ(quiet.Resume(round), Script::Result::kRunning);
  EXPECT_EQ(quiet.looks, 0U);

  World greedy("function run(bot) while true do bot:near() end end");
  for (std::uint32_t body = 100; body < 1100; ++body) greedy.AddBody(body, {2, 2, 0});
  EXPECT_EQ(greedy.Resume(0), Script::Result::kFailed);
  EXPECT_EQ(greedy.error.find("test.lua:1: stopped"), 0U) << greedy.error;
  EXPECT_LT(greedy.looks, 40U);
}

TEST(BotScriptWorld, KnowsItsOwnBodyAndItsMotion) {
  World world("function run(bot) print(bot:body(), bot:velocity()) bot:wait(0) print(bot:velocity()) end");
  EXPECT_EQ(world.Resume(0), Script::Result::kRunning) << world.error;
  world.view.self->velocity = protocol::Vector3{3, 0, -1};
  EXPECT_EQ(world.Resume(1), Script::Result::kFinished) << world.error;
  EXPECT_EQ(world.printed, "7\tnil\n3.0\t0.0\t-1.0\n");
}

TEST(BotScriptWorld, HandsGrabPushCutAndBuild) {
  World world(R"(function run(bot)
    print(bot:grab(9), bot:grab(4))
    bot:wait(0)
    bot:grab(9, 1, 2, 3)
    print(bot:push(9), bot:push(9, 0, 0, 2), bot:push(4))
    bot:cut(9, 1, 2, 3, 4, 5, 6)
    bot:build('add_spring', {a = 3, b = 4, length = 2})
    bot:wait(0)
    bot:release()
    bot:wait(0)
    for i = 1, 9 do bot:push(9) end
  end)");
  world.AddBody(9, {1, 5, 0});
  protocol::Vector3 asked;
  world.view.findBody = [&](std::uint32_t body) { return body == 9 ? std::optional(world.bodies[1]) : std::nullopt; };
  world.view.findVertex = [&](std::uint32_t body, const protocol::Vector3& place) {
    asked = place;
    return body == 9 ? std::optional<std::uint16_t>(21) : std::nullopt;
  };
  ASSERT_EQ(world.Resume(0), Script::Result::kRunning) << world.error;
  EXPECT_EQ(world.printed, "true\tfalse\n");
  ASSERT_TRUE(world.wish.hand);
  EXPECT_EQ(world.wish.hand->body, 9U);
  EXPECT_EQ(world.wish.hand->vertex, 21U);
  EXPECT_EQ(world.wish.hand->target.x, 1) << "its own centre";
  EXPECT_EQ(asked.y, 1) << "the vertex that is nearest to its own centre";
  world.printed.clear();
  ASSERT_EQ(world.Resume(0.1), Script::Result::kRunning) << world.error;
  EXPECT_EQ(world.printed, "true\ttrue\tfalse\n");
  EXPECT_EQ(world.wish.hand->target.z, 3);
  ASSERT_EQ(world.wish.deeds.size(), 4U);
  EXPECT_EQ(std::get<Script::Push>(world.wish.deeds[0]).direction.y, 4) << "away from itself";
  EXPECT_EQ(std::get<Script::Push>(world.wish.deeds[1]).direction.z, 2);
  EXPECT_EQ(std::get<Script::Cut>(world.wish.deeds[2]).eye.x, 1) << "its own centre";
  EXPECT_EQ(std::get<Script::Cut>(world.wish.deeds[2]).to.z, 6);
  const auto& build = std::get<protocol::BuildFields>(world.wish.deeds[3]);
  EXPECT_EQ(build.kind, wire::BuildKind::AddSpring);
  EXPECT_EQ(build.b, 4);
  EXPECT_EQ(build.restLength, 2);
  EXPECT_EQ(build.stiffness, 100) << "the default";
  ASSERT_EQ(world.Resume(0.2), Script::Result::kRunning) << world.error;
  EXPECT_FALSE(world.wish.hand);
  EXPECT_TRUE(world.wish.deeds.empty()) << "once";
  EXPECT_EQ(world.Resume(0.3), Script::Result::kFailed);
  EXPECT_NE(world.error.find("more than 8 pushes, cuts and builds without a bot:wait"), std::string::npos)
      << world.error;
}

TEST(BotScriptWorld, HandsNameWhatIsWrong) {
  const std::vector<std::pair<std::string, std::string>> faults{
      {"bot:grab(0)", "#1 to 'grab' (must be the number of a body, 1 or more)"},
      {"bot:grab('ball')", "#1 to 'grab' (number expected, got string)"},
      {"bot:grab(9, 1, 2)", "#4 to 'grab' (number expected, got no value)"},
      {"bot:grab(9, 1, 2, 9000)", "#4 to 'grab' (must be a number of -8192 to 8192)"},
      {"bot:grab(9, 0/0, 0, 0)", "#2 to 'grab' (must be a number of -8192 to 8192)"},
      {"bot:push(9, 0, 0, 0)", "#2 to 'push' (must be a direction, not 0, 0, 0)"},
      {"bot:push(1e10)", "#1 to 'push' (must be the number of a body, 1 or more)"},
      {"bot:cut(9, 1, 2, 3)", "#5 to 'cut' (number expected, got no value)"},
      {"bot:build('house', {})", "#1 to 'build' (must be add_particle, add_spring"},
      {"bot:build('add_particle')", "#2 to 'build' (table expected, got no value)"},
      {"bot:build('add_particle', {mass = -1})", "#2 to 'build' (mass -1: must be a number of 0.0 to 1000000.0)"},
      {"bot:build('add_particle', {x = 'a'})", "#2 to 'build' (x a: must be a number of -8192.0 to 8192.0)"},
      {"bot:build('add_spring', {a = 70000})", "#2 to 'build' (a 70000: must be a number of 0.0 to 65535.0)"}};
  for (const auto& [call, words] : faults) {
    World world("function run(bot) " + call + " end");
    EXPECT_EQ(world.Resume(0), Script::Result::kFailed) << call;
    EXPECT_NE(world.error.find("bad argument " + words), std::string::npos) << call << ": " << world.error;
    EXPECT_FALSE(world.wish.hand);
    EXPECT_TRUE(world.wish.deeds.empty());
  }
}

TEST(BotScriptWorld, KnowsTheGame) {
  World world(R"(function run(bot)
    print(bot:game())
    bot:wait(0)
    local g = bot:game()
    print(g.kind, g.phase, g.round, g.rounds, g.seconds_left, g.points_to_win, g.points, g.side)
    print(g.sides[1].points, g.sides[2].rounds, g.object.body, g.object.distance, g.bearer)
    for _, p in ipairs(g.players) do print(p.body, p.name, p.points, p.rounds, p.side, p.own) end
    for _, e in ipairs(bot:events()) do print(e.kind, e.own) end
  end)");
  world.AddBody(9, {1, 5, 0});
  ASSERT_EQ(world.Resume(0), Script::Result::kRunning) << world.error;
  const client::Scoreboard board{.phase = wire::GamePhase::Golden,
                                 .round = 2,
                                 .secondsLeft = 31,
                                 .pointsToWin = 5,
                                 .scores = {{4, 3, 1}, {3, 2, 0}},
                                 .rounds = 3,
                                 .seats = {{1, true, false}, {2, true, true}},
                                 .sides = {{3, 1}, {2, 0}},
                                 .object = 9,
                                 .bearer = 4};
  const std::unordered_map<std::uint32_t, std::uint32_t> bodies{{3, 7}, {4, 8}};
  world.names = {{8, "Ada"}};
  world.view.client = 3;
  world.view.game = "goals";
  world.view.scoreboard = &board;
  world.view.bodies = &bodies;
  world.view.findBody = [&](std::uint32_t) { return std::optional(world.bodies[1]); };
  world.events.push_back({wire::EventKind::Goal, 3, 9, ""});
  world.events.push_back({wire::EventKind::Crown, 4, 9, ""});
  EXPECT_EQ(world.Resume(0.1), Script::Result::kFinished) << world.error;
  EXPECT_EQ(world.printed,
            "nil\n"
            "goals\tgolden\t2\t3\t31\t5\t2\t2\n"
            "3\t0\t9\t4.0\t8\n"
            "8\tAda\t3\t1\t1\tfalse\n"
            "7\tnil\t2\t0\t2\ttrue\n"
            "goal\ttrue\ncrown\tfalse\n");
}

TEST(BotScriptWorld, EventsAreHandedOutOnce) {
  World world(R"(function run(bot)
    for i = 1, 2 do
      for _, e in ipairs(bot:events()) do print(e.kind, e.body, e.name, e.own) end
      print(#bot:events())
      bot:wait(0)
    end
  end)");
  world.events = {{wire::EventKind::Join, 1, 7, "bot 1"}, {wire::EventKind::Respawn, 0, 7, ""}};
  EXPECT_EQ(world.Resume(0), Script::Result::kRunning) << world.error;
  world.events = {{wire::EventKind::Leave, 2, 0, "watcher"}, {wire::EventKind::BodyRemoved, 0, 9, ""}};
  EXPECT_EQ(world.Resume(1), Script::Result::kRunning) << world.error;
  EXPECT_EQ(world.printed,
            "join\t7\tbot 1\ttrue\nrespawn\t7\tnil\ttrue\n0\n"
            "leave\tnil\twatcher\tfalse\nremoved\t9\tnil\tfalse\n0\n");
}

TEST(BotScriptWorld, LeavesWaitsAndJoinsAgain) {
  World world(R"(function run(bot)
    bot:join()  -- is in already
    bot:move(1, 0) bot:puff(true)
    bot:leave()
    print('away', bot:time(), bot:position(), bot:body(), #bot:near(), #bot:events())
    bot:wait(2)
    bot:join()
    print('back', bot:time(), bot:body())
  end)");
  EXPECT_EQ(world.Resume(0), Script::Result::kRunning) << world.error;
  EXPECT_FALSE(world.wish.play);
  EXPECT_FALSE(world.wish.input.puff);  // its input is neutral
  world.view.isPlaying = false;         // leaving
  EXPECT_EQ(world.Resume(0.5), Script::Result::kRunning) << world.error;
  EXPECT_EQ(world.printed, "");
  world.view.isAway = true;
  world.view.self.reset();
  EXPECT_EQ(world.Resume(1), Script::Result::kRunning) << world.error;
  EXPECT_EQ(world.printed, "away\t1.0\tnil\tnil\t0\t0\n");
  EXPECT_EQ(world.Resume(2.9), Script::Result::kRunning) << world.error;
  EXPECT_FALSE(world.wish.play);
  EXPECT_EQ(world.Resume(3), Script::Result::kRunning) << world.error;
  EXPECT_TRUE(world.wish.play);
  EXPECT_EQ(world.wish.input.moveX, 0);
  world.view.isAway = false;
  EXPECT_EQ(world.Resume(4), Script::Result::kRunning) << world.error;
  world.view.isPlaying = true;
  EXPECT_EQ(world.Resume(5), Script::Result::kFinished) << world.error;
  EXPECT_EQ(world.printed, "away\t1.0\tnil\tnil\t0\t0\nback\t5.0\t7\n");
  EXPECT_TRUE(world.wish.play);
}

TEST(BotScriptWorld, ShippedScriptsRun) {
  for (const char* name : {"chase", "mash", "storm", "wander", "idle"}) {
    Script script(3, [](unsigned, std::string_view text) { ADD_FAILURE() << text; });
    std::string error;
    ASSERT_TRUE(script.LoadFile(test::FindSource(std::string("client/bots/scripts/") + name + ".lua"), error)) << error;
    ASSERT_EQ(script.AddBot(error), 1U);
    Script::View view;
    view.body = 7;
    view.listBodies = [](std::vector<client::Sighting>& sightings) {
      sightings = {{8, {{2, 0, 0}, {}}, protocol::Vector3{1, 0, 0}, 0}};
    };
    std::unordered_map<std::uint32_t, std::string> names{{8, "Ada"}};
    view.names = &names;
    unsigned moving = 0, jumping = 0, leaving = 0;
    Script::Wish wish;
    for (int round = 0; round < 1200; ++round) {
      view.time = round / 60.0;
      view.isPlaying = wish.play;
      view.isAway = !wish.play;
      view.self.reset();
      if (view.isPlaying && round > 5)
        view.self = client::Sighting{7, {{0.1F * static_cast<float>(round % 100), 0, 0}, {}}, {}, 0};
      ASSERT_NE(script.Resume(1, view, wish, error), Script::Result::kFailed) << error;
      moving += wish.input.moveX != 0 ? 1 : 0;
      jumping += wish.input.jump ? 1 : 0;
      leaving += wish.play ? 0 : 1;
    }
    const std::string which = name;
    EXPECT_EQ(moving > 300, which != "idle") << name << ' ' << moving;
    EXPECT_EQ(jumping > 10, which != "idle" && which != "storm") << name << ' ' << jumping;
    EXPECT_EQ(leaving > 100, which == "storm") << name << ' ' << leaving;
  }
}

TEST(LuaCosts, PatternStepsGrowWithTheRepeats) {
  EXPECT_NEAR(CountPatternSteps(10, "abc", true), 1, 0.5);
  EXPECT_NEAR(CountPatternSteps(10, "a%-%+%%", true), 1, 0.5);  // escaped: no repeats
  EXPECT_GT(CountPatternSteps(10, "abc", false), 10);           // tried from every start
  EXPECT_GT(CountPatternSteps(100, "^a*b*", true), 100.0 * 100 / 2);
  EXPECT_GT(CountPatternSteps(100, "%b()%1", false), 100.0 * 100 * 100 / 6);
  EXPECT_LT(CountPatternSteps(32, "^%s*(.-)%s*$", true), 20'000);
  EXPECT_GT(CountPatternSteps(1000, std::string(5000, '-'), false), 1e12);
}

}  // namespace
}  // namespace wobble::bots
