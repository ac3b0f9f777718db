// A restored world goes on as the captured one does, to the bit, in every shipped scene; and a state that the engine
// cannot bear is refused by the name of what is wrong with it.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <limits>

#include "server/physics/world_state.h"
#include "server/scenes/loader.h"
#include "tests/support/places.h"

namespace wobble {
namespace {

using physics::World;
using physics::WorldState;

constexpr int kTickHz = 60;

scenes::Scene Load(const std::string& name) { return scenes::LoadScene(name, test::FindSource("server/scenes")).scene; }

// A world of a scene with two players; the second is shoved about by step forces and cuts what it can.
struct Played {
  explicit Played(const scenes::Scene& scene, int threads = 1)
      : rules(scene.player), world(scenes::MakeWorldSettings(scene, 1.0 / kTickHz, threads)) {
    [[maybe_unused]] const auto placed = scenes::FillWorld(scene, 1, world);
    for (std::uint32_t i = 0; i < 2; ++i) {
      players[i] = world.AddBody(static_cast<std::uint8_t>(rules.blueprint), scenes::FindSpawn(rules, i + 1));
    }
  }

  void Step() {
    const auto tick = static_cast<int>(world.Tick());
    physics::Control control;
    control.moveX = tick % 120 < 60 ? 0.6 : -0.6;
    control.moveY = tick % 200 < 100 ? 0.8 : -0.8;
    control.jump = tick % 45 < 5;
    control.puff = tick % 90 < 30;
    if (tick < 150) world.SetControl(players[0], control, rules.limits);
    if (tick == 150) world.SetControl(players[0], {}, rules.limits);
    if (tick % 50 < 10) {
      world.PushVertices(players[1], std::vector<physics::VertexForce<double>>{{1, {30, 10, 40}}});
    }
    if (tick % 40 == 5) {
      for (const physics::Body& body : world.Bodies()) {
        const physics::Vector3d at = world.FindCentre(body);
        if (body.id % 2 == 0)
          world.CutSprings(body.id, {at, at + physics::Vector3d(0.3, 0, 0.1), at + physics::Vector3d(0, 0.3, 0.4)});
      }
    }
    world.Step();
  }

  scenes::PlayerRules rules;
  World world;
  std::array<physics::BodyId, 2> players{};
};

class RestoredScene : public testing::TestWithParam<std::string> {};

TEST_P(RestoredScene, GoesOnToTheBit) {
  const scenes::Scene scene = Load(GetParam());
  Played original(scene);
  // Another world's past must not show through.
  Played restored(scene, 2);
  for (int tick = 0; tick < 15; ++tick) restored.Step();
  for (const int at : {20, 160}) {
    while (original.world.Tick() < static_cast<std::uint32_t>(at)) original.Step();
    const WorldState state = original.world.Capture();
    ASSERT_EQ(restored.world.Restore(state), "");
    ASSERT_EQ(restored.world.Hash(), original.world.Hash());
    for (int tick = 0; tick < 30; ++tick) {
      original.Step();
      restored.Step();
      ASSERT_EQ(restored.world.Hash(), original.world.Hash()) << "captured at " << at << ", tick " << tick;
    }
  }
}

// By the files' names, since every test of this program asks for them: to load the scenes takes half a second.
std::vector<std::string> ListNames() {
  std::vector<std::string> names;
  for (const auto& file : std::filesystem::directory_iterator(test::FindSource("server/scenes"))) {
    if (file.path().extension() == ".toml") names.push_back(file.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

INSTANTIATE_TEST_SUITE_P(Shipped, RestoredScene, testing::ValuesIn(ListNames()),
                         [](const auto& scene) { return scene.param; });

// The state of the arena after two seconds, for the test to spoil.
class UnsoundState : public testing::Test {
 protected:
  UnsoundState() : played(Load("curtain")) {
    for (int tick = 0; tick < 120; ++tick) played.Step();
    state = played.world.Capture();
  }
  // The reason for which the world refuses the state. It must go on as if nothing had been.
  std::string Refuse() {
    const std::uint64_t before = played.world.Hash();
    std::string error = played.world.Restore(state);
    EXPECT_EQ(played.world.Hash(), before);
    played.Step();
    return error;
  }
  template <class Real = float>
  physics::State<Real>& StateOf(std::size_t body) {
    return std::get<physics::State<Real>>(state.bodies[body].state);
  }

  Played played;
  WorldState state;
};

TEST_F(UnsoundState, NamesBodies) {
  state.bodies[1].blueprint = 77;
  EXPECT_EQ(Refuse(), "body 2: blueprint 77: must be one of the world's");
}

TEST_F(UnsoundState, NamesVertices) {
  StateOf(0).positions.pop_back();
  EXPECT_NE(Refuse().find("positions"), std::string::npos);
}

TEST_F(UnsoundState, NamesContacts) {
  StateOf(0).contacts.push_back({.surface = 9999});
  EXPECT_NE(Refuse().find("contacts"), std::string::npos);
}

TEST_F(UnsoundState, NamesNumbers) {
  state.nextId = 1;
  EXPECT_NE(Refuse().find("nextId 1"), std::string::npos);
}

TEST_F(UnsoundState, NamesPairs) {
  auto& pairs = std::get<physics::PairsState<float>>(state.pairs);
  pairs.awake.clear();
  pairs.resting.clear();
  physics::BodyPair<float> pair;
  pair.first = state.bodies[0].id;
  pair.second = state.bodies[1].id;
  pair.sides[0].push_back({.vertex = 1, .face = 60000});
  pairs.awake.push_back(pair);
  EXPECT_NE(Refuse().find("pair.sides"), std::string::npos);
  pair.second = 4711;
  pairs.awake = {pair};
  EXPECT_NE(Refuse().find("pair.second 4711"), std::string::npos);
}

TEST_F(UnsoundState, NamesBlueprints) {
  state.slots.push_back({.age = 1, .recipe = {.base = 200, .parts = {}, .torn = {}}});
  EXPECT_NE(Refuse().find("base 200"), std::string::npos);
  state.slots.back().recipe = {.base = 0, .parts = {}, .torn = {1, 0}};
  EXPECT_NE(Refuse().find("torn springs 2"), std::string::npos);
}

TEST_F(UnsoundState, BearsPositionsThatAreNoNumbers) {
  const auto awake =
      static_cast<std::size_t>(std::ranges::find(state.bodies, false, &physics::Body::asleep) - state.bodies.begin());
  ASSERT_LT(awake, state.bodies.size());
  StateOf(awake).positions[0].x() = std::numeric_limits<float>::quiet_NaN();
  ASSERT_EQ(played.world.Restore(state), "");
  for (int tick = 0; tick < 10; ++tick) played.Step();
  EXPECT_TRUE(played.world.FindCentre(played.world.Bodies()[awake]).allFinite());
}

}  // namespace
}  // namespace wobble
