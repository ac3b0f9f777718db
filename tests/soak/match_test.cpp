// Whole matches of the shipped games by the shipped bots: over the real server and client, on virtual time, recorded
// and played again.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "client/bots/runner.h"
#include "server/recording/verify.h"
#include "tests/bench/thread_time.h"
#include "tests/support/game.h"
#include "tests/support/places.h"
#include "tests/unit/recording/matches.h"

namespace wobble::bots {
namespace {

using Phase = server::Match::Phase;

struct Played {
  int matches = 0;
  int points = 0;   // of all, over the match
  int changes = 0;  // of who wears the crown
  bool hasKickedOff = false;
  std::string proof;
  Figures figures;
};

// Plays a match of one round of so many seconds with so many bots.
Played PlayMatch(const std::string& name, unsigned count, double seconds) {
  const recording::Folder folder;
  scenes::LoadResult loaded = scenes::LoadScene(name, test::FindSource("server/scenes"));
  EXPECT_TRUE(loaded.errors.empty());
  // A recording stores the scene's text: what is shorter here has to stand there.
  const std::string rule = "\nround = ";
  const auto from = loaded.source.text.find(rule);
  loaded.source.text.replace(from, loaded.source.text.find('\n', from + 1) - from, rule + std::to_string(seconds));
  loaded = scenes::ParseScene(loaded.source);
  EXPECT_TRUE(loaded.errors.empty());
  test::Game game(loaded.scene, {.rounds = 1});
  game.server.Record(recording::MakeSettings(folder),
                     {.version = "test", .scene = loaded.source, .tickHz = 60, .seed = 1, .beginsFresh = true});
  LoadTestOptions options;
  options.count = count;
  options.decodeShare = {.part = 0, .whole = 1};
  Script script(options.seed, {});
  std::string error;
  EXPECT_TRUE(script.LoadFile(test::FindSource("client/bots/scripts/" + name + ".lua"), error)) << error;
  Runner runner(
      options, script, [&](auto, std::string&) { return game.network.MakeClient(); }, [] { return 0.0; },
      [](std::string_view line) { ADD_FAILURE() << line; });
  Played played;
  std::uint32_t bearer = 0;
  const double limit = 3 * seconds + 120;
  while (played.matches == 0 && game.now < limit) {
    game.Step();
    runner.RunRound(game.now, 0);
    const server::Game* rules = game.server.ReadGame();
    played.matches = rules->ReadMatch().Read().matches;
    played.hasKickedOff = played.hasKickedOff || rules->ReadMatch().ReadPhase() == Phase::kKickOff;
    if (rules->Bearer() != bearer && rules->Bearer() != 0) ++played.changes;
    bearer = rules->Bearer();
    int points = 0;
    for (const auto& each : rules->ReadMatch().Standings()) points += each.points;
    played.points = std::max(played.points, points);
  }
  played.figures = runner.ReadFigures();
  EXPECT_TRUE(game.server.IsMatchOver());
  game.server.EndRecording();
  for (const auto& file : folder.List()) {
    const recording::Proof proof =
        recording::Verify(file, {.threads = 1, .widestPack = 8}, [](double, double) { return true; });
    if (proof.verdict != recording::Verdict::kIdentical) played.proof += proof.words;
  }
  EXPECT_FALSE(folder.List().empty());
  return played;
}

void ExpectPlayed(const Played& played, unsigned count) {
  EXPECT_EQ(played.matches, 1);
  EXPECT_TRUE(played.hasKickedOff);
  EXPECT_EQ(played.figures.connected, count);
  EXPECT_EQ(played.figures.scriptErrors, 0U);
  EXPECT_EQ(played.figures.disconnects, 0U);
  EXPECT_EQ(played.proof, "") << "the recording plays the same again, to the bit";
}

// Sets `ticks` to the processor time of each tick from the fifth second to the twentieth, s.
void TimeTicksOfGoals(std::vector<double>& ticks) {
  test::Game game(test::LoadShippedScene("goals"));
  LoadTestOptions options;
  options.count = 16;
  options.decodeShare = {.part = 0, .whole = 1};
  Script script(options.seed, {});
  std::string error;
  ASSERT_TRUE(script.LoadFile(test::FindSource("client/bots/scripts/goals.lua"), error)) << error;
  Runner runner(
      options, script, [&](auto, std::string&) { return game.network.MakeClient(); }, [] { return 0.0; },
      [](std::string_view line) { ADD_FAILURE() << line; });
  while (game.now < 20) {
    const double begin = bench::ReadThreadTime();
    game.Step();
    if (game.now > 5) ticks.push_back(bench::ReadThreadTime() - begin);
    runner.RunRound(game.now, 0);
  }
  EXPECT_EQ(runner.ReadFigures().connected, 16U);
}

// Other programs lengthen processor time, too: they share the caches. So the match, which is the same each time, is
// played up to three times, and the least time of each tick counts.
TEST(MatchOfBots, SixteenAtGoalsLeaveTimeInATick) {
  std::vector<double> least;
  double p99 = 1;
  for (int play = 0; play < 3 && p99 >= 1.0 / 60; ++play) {
    std::vector<double> ticks;
    ASSERT_NO_FATAL_FAILURE(TimeTicksOfGoals(ticks));
    if (least.empty()) least = ticks;
    ASSERT_EQ(ticks.size(), least.size());
    for (std::size_t i = 0; i < ticks.size(); ++i) least[i] = std::min(least[i], ticks[i]);
    std::vector<double> sorted = least;
    std::ranges::sort(sorted);
    p99 = sorted[sorted.size() * 99 / 100];
    std::printf("a tick of goals with 16 bots: %.2f ms (p50), %.2f ms (p99) of processor time, the least of %d\n",
                1e3 * sorted[sorted.size() / 2], 1e3 * p99, play + 1);
  }
  EXPECT_LT(p99, 1.0 / 60);
}

TEST(MatchOfBots, GoalsAreScored) {
  const Played played = PlayMatch("goals", 6, 25);
  ExpectPlayed(played, 6);
  EXPECT_GE(played.points, 1);
}

TEST(MatchOfBots, TheCrownChangesHands) {
  const Played played = PlayMatch("crown", 4, 30);
  ExpectPlayed(played, 4);
  EXPECT_GE(played.points, 10);
  EXPECT_GE(played.changes, 3);
}

}  // namespace
}  // namespace wobble::bots
