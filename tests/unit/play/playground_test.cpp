// The same entries at the same ticks give the same bits: on any number of threads, played again from what a listener
// heard, and from a captured state on. Entries that cannot be do nothing.
#include "server/play/playground.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "server/play/playground_state.h"
#include "tests/support/game.h"

namespace wobble::server {
namespace {

struct Heard {
  std::uint32_t tick = 0;  // played before it
  Entry entry;
};

// Three players who join, run, hold, shove, cut, build and tune; the third leaves and comes back as a spectator.
void Act(Playground& ground) {
  const auto tick = ground.World().Tick();
  const auto body = [&](std::size_t place) { return ground.World().Bodies()[place].id; };
  for (ClientId client = 1; client <= 3; ++client) {
    if (tick == 5 * (client - 1)) ground.Take(JoinEntry{client, false, "player"});
  }
  const physics::Vector3d at = ground.World().FindCentre(ground.World().Bodies()[0]);
  for (ClientId client = 1; client <= 3; ++client) {
    if (tick % 30 == client) {
      MoveEntry move{.client = client, .control = {}, .hand = {}};
      move.control.moveX = tick % 60 < 30 ? 0.7 : -0.7;
      move.control.jump = tick % 90 < 30;
      if (tick % 60 > 30) move.hand = HandCommand{body(0), 1, static_cast<std::uint16_t>(1 + tick / 60), at};
      ground.Take(move);
    }
  }
  if (tick % 50 == 20) ground.Take(ActEntry{.client = 1, .command = ShoveCommand{body(0), 2, {1, 0, 1}}});
  if (tick % 50 == 30) {
    const CutCommand cut{body(std::min<std::size_t>(2, ground.World().Bodies().size() - 1)),
                         at + physics::Vector3d(0, -2, 1), at - physics::Vector3d(1, 0, 0),
                         at + physics::Vector3d(1, 0, 0.2)};
    ground.Take(ActEntry{.client = 2, .command = cut});
  }
  if (tick % 40 == 7) {
    BuildCommand build;
    build.at = at + physics::Vector3d(0.5, 0, 0.5);
    ground.Take(ActEntry{.client = 2, .command = build});
  }
  if (tick == 70) ground.Take(ActEntry{.client = 1, .isHost = true, .command = TuneCommand{.value = {0, 0, -5}}});
  if (tick == 90) ground.Take(ProtectEntry{true});
  if (tick == 100) ground.Take(LeaveEntry{3});
  if (tick == 110) ground.Take(JoinEntry{4, true, "watcher"});
  if (tick == 150) ground.Take(ResetEntry{});
  if (tick == 190) ground.Take(RestartEntry{});
}

constexpr int kTicks = 220;

class PlaygroundOf : public testing::TestWithParam<std::string> {
 protected:
  [[nodiscard]] Playground Make(int threads = 1) const {
    return Playground(test::LoadShippedScene(GetParam()), {.threads = threads});
  }
};

TEST_P(PlaygroundOf, PlaysTheSameAgain) {
  Playground first = Make();
  std::vector<Heard> heard;
  first.SetListener([&](const Entry& entry) { heard.push_back({first.World().Tick(), entry}); });
  Playground again = Make(2);
  std::size_t next = 0;
  for (int tick = 0; tick < kTicks; ++tick) {
    Act(first);
    for (; next < heard.size(); ++next) again.Take(heard[next].entry);
    first.Step();
    again.Step();
    ASSERT_EQ(first.World().Hash(), again.World().Hash()) << "tick " << tick;
    ASSERT_EQ(first.TakeHappenings().size(), again.TakeHappenings().size());
  }
}

TEST_P(PlaygroundOf, GoesOnFromAState) {
  Playground first = Make();
  Playground other = Make();
  for (int tick = 0; tick < kTicks; ++tick) {
    if (tick == 33 || tick == 125 || tick == 193) {
      Playground restored = Make(2);
      ASSERT_EQ(restored.Restore(first.Capture()), "");
      ASSERT_EQ(other.Restore(first.Capture()), "");
    }
    Act(first);
    first.Step();
    if (tick < 33) continue;
    Act(other);
    other.Step();
    ASSERT_EQ(first.World().Hash(), other.World().Hash()) << "tick " << tick;
  }
}

INSTANTIATE_TEST_SUITE_P(Shipped, PlaygroundOf,
                         testing::Values("arena", "curtain", "sandbox", "sumo", "goals", "crown", "wind"),
                         [](const auto& scene) { return scene.param; });

TEST(Playground, BeginsAnewWhole) {
  Playground ground(test::LoadShippedScene("curtain"), {});
  const auto count = [&] { return ground.World().BlueprintOf(ground.World().Bodies()[2]).full.springs.size(); };
  const std::size_t whole = count();
  ground.Take(JoinEntry{1, false, "vandal"});
  const physics::Vector3d at = ground.World().FindCentre(ground.World().Bodies()[2]);
  const CutCommand cut{ground.World().Bodies()[2].id, at + physics::Vector3d(0, -1.5, 0),
                       at + physics::Vector3d(-1.5, 0.5, 0), at + physics::Vector3d(1.5, 0.5, 0.1)};
  ASSERT_EQ(ground.Take(ActEntry{.client = 1, .command = cut}), "");
  for (int tick = 0; tick < 60; ++tick) ground.Step();
  ASSERT_LT(count(), whole);
  ground.Take(ResetEntry{});
  ASSERT_LT(count(), whole) << "what is torn stays torn";
  ground.Take(RestartEntry{});
  EXPECT_EQ(count(), whole);
  ground.Step();
  EXPECT_NE(ground.FindPlayer(1)->body, 0U);

  // It goes on as a new one does, at the same places.
  Playground fresh(test::LoadShippedScene("curtain"), {});
  ground.Take(RestartEntry{});
  fresh.Step();
  ground.Step();
  EXPECT_EQ(ground.World().FindCentre(ground.World().Bodies()[2]), fresh.World().FindCentre(fresh.World().Bodies()[2]));
}

TEST(Playground, BearsEntriesThatCannotBe) {
  Playground ground(test::LoadShippedScene("sandbox"), {});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  ground.Take(JoinEntry{1, false, "player"});
  const std::size_t bodies = ground.World().Bodies().size();
  ground.Take(JoinEntry{1, false, "again"});
  ground.Take(JoinEntry{0, false, "nobody"});
  ground.Take(LeaveEntry{9});
  ground.Take(MoveEntry{.client = 9, .control = {.moveX = 1}, .hand = {}});
  ground.Take(MoveEntry{.client = 1, .control = {.moveX = nan}, .hand = {}});
  ground.Take(MoveEntry{.client = 1, .control = {.moveX = 5}, .hand = {}});
  ground.Take(MoveEntry{.client = 1, .control = {}, .hand = HandCommand{1, 60000, 1, {nan, 0, 0}}});
  ground.Take(MoveEntry{.client = 1, .control = {}, .hand = HandCommand{1, 60000, 1, {0, 0, 0}}});
  ground.Take(ActEntry{.client = 1, .command = ShoveCommand{1, 60000, {1, 0, 0}}});
  ground.Take(ActEntry{.client = 1, .command = ShoveCommand{1, 0, {nan, 0, 0}}});
  ground.Take(ActEntry{.client = 1, .command = CutCommand{99, {nan, 0, 0}, {0, 0, 0}, {0, 0, 0}}});
  ground.Take(ActEntry{.client = 1, .isHost = true, .command = TuneCommand{.value = {nan, 0, 0}}});
  ground.Take(ActEntry{.client = 1, .isHost = true, .command = TuneCommand{.kind = TuneCommand::Kind::kJump}});
  BuildCommand build;
  build.at = {nan, 0, 0};
  ground.Take(ActEntry{.client = 1, .command = build});
  for (int tick = 0; tick < 30; ++tick) ground.Step();
  EXPECT_EQ(ground.World().Bodies().size(), bodies);
  EXPECT_EQ(ground.Players().size(), 1U);
  EXPECT_TRUE(ground.ReadTuning().IsUsual());
}

TEST(Playground, RefusesStatesOfOthers) {
  Playground arena(test::LoadShippedScene("arena"), {});
  Playground sumo(test::LoadShippedScene("sumo"), {});
  EXPECT_NE(arena.Restore(sumo.Capture()), "");
  PlaygroundState state = sumo.Capture();
  state.players[4].body = 4711;
  EXPECT_THAT(sumo.Restore(state), testing::HasSubstr("players"));

  // A spoiled state came as far as the step, with a move without bounds.
  sumo.Take(JoinEntry{7, false, "fast"});
  PlaygroundState fast = sumo.Capture();
  fast.players.at(7).control.moveX = 1e30;
  EXPECT_THAT(sumo.Restore(fast), testing::HasSubstr("players"));
  fast.players.at(7).control.moveX = 0;
  fast.players.at(7).hand = HandCommand{.body = 1, .target = physics::Vector3d(0, std::nan(""), 0)};
  EXPECT_THAT(sumo.Restore(fast), testing::HasSubstr("players"));
}

}  // namespace
}  // namespace wobble::server
