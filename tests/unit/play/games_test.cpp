// The shipped games on the playground: what the ball, hands and pushes do there.
#include <gmock/gmock.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "server/play/playground.h"
#include "server/play/playground_state.h"
#include "tests/support/game.h"

namespace wobble::server {
namespace {

using physics::Vector3d;
using Phase = Match::Phase;

Vector3d CentreOf(const Playground& ground, physics::BodyId body) {
  return ground.World().FindCentre(ground.World().ReadBody(body));
}
Vector3d PlayerAt(const Playground& ground, ClientId client) {
  return CentreOf(ground, ground.FindPlayer(client)->body);
}
Phase PhaseOf(const Playground& ground) { return ground.ReadGame()->ReadMatch().ReadPhase(); }

void PassTime(Playground& ground, double seconds) {
  for (int tick = 0; tick < 60 * seconds; ++tick) ground.Step();
}

// Puts a body there, at rest in its present shape.
void Put(Playground& ground, physics::BodyId body, const Vector3d& centre) {
  MotionEntry motion{.body = body, .positions = {}, .velocities = {}};
  const Vector3d way = centre - CentreOf(ground, body);
  physics::VisitVertices(ground.World().ReadBody(body),
                         [&](std::size_t, const Vector3d& place) { motion.positions.emplace_back(place + way); });
  motion.velocities.resize(motion.positions.size(), Vector3d::Zero());
  ground.Take(motion);
}

// A match of these people that has begun.
std::unique_ptr<Playground> Begin(const std::string& scene, ClientId players) {
  auto begun = std::make_unique<Playground>(test::LoadShippedScene(scene), PlaygroundSettings{});
  Playground& ground = *begun;
  for (ClientId client = 1; client <= players; ++client) {
    ground.Take(JoinEntry{client, false, "player"});
    ground.Take(ReadyEntry{client, true});
  }
  PassTime(ground, 3.1);
  static_cast<void>(ground.TakeHappenings());
  return begun;
}

std::vector<Happening> Find(Playground& ground, Happening::Kind kind) {
  std::vector<Happening> found = ground.TakeHappenings();
  std::erase_if(found, [kind](const Happening& each) { return each.kind != kind; });
  return found;
}

void Grab(Playground& ground, ClientId client, physics::BodyId body, std::uint16_t grip) {
  ground.Take(MoveEntry{.client = client, .control = {}, .hand = HandCommand{body, 0, grip, CentreOf(ground, body)}});
}

TEST(Games, SidesKickOffOnTheirHalvesAndAGoalPutsAllBack) {
  const auto begun = Begin("goals", 4);
  Playground& ground = *begun;
  ASSERT_EQ(PhaseOf(ground), Phase::kPlaying);
  const physics::BodyId ball = ground.ReadGame()->Object();
  for (const ClientId client : {1U, 3U}) EXPECT_LT(PlayerAt(ground, client).x(), -3);
  for (const ClientId client : {2U, 4U}) EXPECT_GT(PlayerAt(ground, client).x(), 3);
  EXPECT_LT(CentreOf(ground, ball).head<2>().norm(), 0.5);

  ground.Take(ActEntry{.client = 1, .command = ShoveCommand{ball, 0, {1, 0, 0}}});
  ground.Step();
  EXPECT_LT(CentreOf(ground, ball).x(), 0.1) << "too far away to push";
  Put(ground, ground.FindPlayer(3)->body, CentreOf(ground, ball) - Vector3d(1.6, 0, 0));
  EXPECT_EQ(ground.Take(ActEntry{.client = 3, .command = ShoveCommand{ball, 0, {1, 0, 0}}}), "");
  PassTime(ground, 0.2);
  Put(ground, ball, {14.2, 0, 1.2});
  ground.Step();
  const auto goals = Find(ground, Happening::Kind::kGoal);
  ASSERT_EQ(goals.size(), 1U);
  EXPECT_EQ(goals[0].by, 3U);
  EXPECT_EQ(goals[0].body, ball);
  EXPECT_EQ(PhaseOf(ground), Phase::kKickOff);
  EXPECT_EQ(ground.ReadGame()->ReadMatch().Read().sides[0].points, 1);
  EXPECT_LT(CentreOf(ground, ball).norm(), 1.5) << "back in the middle";
  EXPECT_LT(PlayerAt(ground, 3).x(), -3);
  ground.Take(MoveEntry{.client = 1, .control = {.moveX = 1}, .hand = {}});
  const double before = PlayerAt(ground, 1).x();
  PassTime(ground, 2.5);
  EXPECT_NEAR(PlayerAt(ground, 1).x(), before, 0.2) << "nobody moves before the kick-off";
  PassTime(ground, 1.5);
  EXPECT_GT(PlayerAt(ground, 1).x(), before + 1);
  EXPECT_THAT(Find(ground, Happening::Kind::kGoal), testing::IsEmpty()) << "once";
}

TEST(Games, ABallThatLeavesThePitchComesBackWithoutAGoal) {
  const auto begun = Begin("goals", 2);
  Playground& ground = *begun;
  const physics::BodyId ball = ground.ReadGame()->Object();
  Put(ground, ball, {14.5, 5, 30});
  PassTime(ground, 6);
  EXPECT_EQ(ground.ReadGame()->ReadMatch().Read().sides[0].points, 0);
  Put(ground, ball, {0, 30, -3});
  PassTime(ground, 2);
  EXPECT_LT(CentreOf(ground, ball).head<2>().norm(), 1);
}

TEST(Games, NobodyHoldsTheBall) {
  const auto begun = Begin("goals", 2);
  Playground& ground = *begun;
  const physics::BodyId ball = ground.ReadGame()->Object();
  Put(ground, ground.FindPlayer(1)->body, CentreOf(ground, ball) - Vector3d(1.7, 0, 0));
  Grab(ground, 1, ball, 1);
  ground.Step();
  EXPECT_TRUE(ground.Capture().hands.grips.empty());
}

TEST(Games, TheCrownIsGrabbedWornGrabbedAwayAndKnockedOff) {
  const auto begun = Begin("crown", 3);
  Playground& ground = *begun;
  const physics::BodyId crown = ground.ReadGame()->Object();
  const Vector3d home = CentreOf(ground, crown);
  Grab(ground, 1, crown, 1);
  ground.Step();
  EXPECT_EQ(ground.ReadGame()->Bearer(), 0U) << "out of reach";
  const auto stand = [&](ClientId client, const Vector3d& place) {
    Put(ground, ground.FindPlayer(client)->body, place);
  };
  stand(1, home + Vector3d(1.3, 0, 0.1));
  Grab(ground, 1, crown, 2);
  ground.Step();
  EXPECT_EQ(ground.ReadGame()->Bearer(), 1U);
  const auto taken = Find(ground, Happening::Kind::kCrown);
  ASSERT_EQ(taken.size(), 1U);
  EXPECT_EQ(taken[0].by, 1U);
  ground.Take(MoveEntry{.client = 1, .control = {.moveX = 1}, .hand = {}});  // no key held
  PassTime(ground, 0.5);
  ground.Take(MoveEntry{.client = 1, .control = {}, .hand = {}});
  PassTime(ground, 2.6);
  EXPECT_EQ(ground.ReadGame()->Bearer(), 1U);
  EXPECT_EQ(ground.ReadGame()->ReadMatch().Find(1)->points, 3);
  const Vector3d over = CentreOf(ground, crown) - PlayerAt(ground, 1);
  EXPECT_LT(over.head<2>().norm(), 0.25) << "on the head";
  EXPECT_GT(over.z(), 0.4);

  stand(2, PlayerAt(ground, 1) + Vector3d(1.1, 0, 0));
  Grab(ground, 2, crown, 1);
  ground.Step();
  EXPECT_EQ(ground.ReadGame()->Bearer(), 2U);
  PassTime(ground, 1.2);
  EXPECT_EQ(ground.ReadGame()->Bearer(), 2U);
  stand(3, PlayerAt(ground, 2) + Vector3d(0, 1.2, 0));
  const physics::BodyId bearer = ground.FindPlayer(2)->body;
  EXPECT_EQ(ground.Take(ActEntry{.client = 3, .command = ShoveCommand{bearer, 0, {0, -1, 0}}}), "");
  ground.Step();
  EXPECT_EQ(ground.ReadGame()->Bearer(), 0U);
  PassTime(ground, 0.5);
  EXPECT_EQ(ground.ReadGame()->Bearer(), 0U) << "a hand that is still closed does not take it back";
}

TEST(Games, WhoLeavesOrFallsLosesTheCrown) {
  const auto begun = Begin("crown", 3);
  Playground& ground = *begun;
  const physics::BodyId crown = ground.ReadGame()->Object();
  const auto take = [&](ClientId client, std::uint16_t grip) {
    Put(ground, ground.FindPlayer(client)->body, CentreOf(ground, crown) + Vector3d(1.2, 0, 0.2));
    Grab(ground, client, crown, grip);
    ground.Step();
    return ground.ReadGame()->Bearer() == client;
  };
  ASSERT_TRUE(take(1, 1));
  ground.Take(LeaveEntry{1});
  EXPECT_EQ(ground.ReadGame()->Bearer(), 0U);
  PassTime(ground, 1.5);
  ASSERT_TRUE(take(2, 1));
  Put(ground, ground.FindPlayer(2)->body, {0, 0, -6});
  ground.Step();
  EXPECT_EQ(ground.ReadGame()->Bearer(), 0U);
  PassTime(ground, 3);
  EXPECT_GT(CentreOf(ground, crown).z(), 0) << "it comes back, too";
}

TEST(Games, AStateOfAnotherGameIsRefused) {
  Playground goals(test::LoadShippedScene("goals"), {});
  PlaygroundState state = goals.Capture();
  state.game->rules = Crown{};
  EXPECT_THAT(goals.Restore(state), testing::HasSubstr("game"));
  state = goals.Capture();
  state.game->match.players[3].client = 4;
  EXPECT_THAT(goals.Restore(state), testing::HasSubstr("game"));
}

}  // namespace
}  // namespace wobble::server
