// What is kept of a world that plays: jumps are no flights, rest costs nothing, and a body whose vertices change is
// cut.
#include "server/export/clip.h"

#include <gmock/gmock.h>

#include "server/scenes/loader.h"
#include "tests/support/places.h"

namespace wobble::exporting {
namespace {

class ClipTest : public testing::Test {
 protected:
  void Open(const std::string& scene) {
    ground.emplace(scenes::LoadScene(scene, test::FindSource("server/scenes")).scene, server::PlaygroundSettings{});
  }
  // Plays so many ticks, each of which is a frame.
  void Play(int ticks) {
    for (int i = 0; i < ticks; ++i) {
      const auto tick = ground->World().Tick();
      Frame frame{.time = tick / 60.0, .tick = tick, .ground = *ground, .bodies = {}};
      for (const physics::Body& body : ground->World().Bodies()) frame.bodies.push_back(&body);
      clip.Add(frame);
      ground->Step();
    }
  }
  [[nodiscard]] std::vector<const Part*> FindParts(physics::BodyId body) {
    std::vector<const Part*> found;
    for (const Part& part : clip.Parts()) {
      if (part.body == body) found.push_back(&part);
    }
    return found;
  }

  std::optional<server::Playground> ground;
  Clip clip;
};

TEST_F(ClipTest, ABodyThatIsPutElsewhereHoldsUntilThen) {
  Open("ball_drop");
  const physics::BodyId body = ground->World().Bodies()[0].id;
  Play(60);
  const float height = clip.Parts()[0].keys.back().centre.z();
  ground->Take(server::ResetEntry{});
  Play(2);
  const std::vector<Key>& keys = FindParts(body).at(0)->keys;
  ASSERT_EQ(keys.size(), 60U + 2 + 1);
  EXPECT_GT(keys[61].centre.z(), height + 1) << "it was put back up";
  EXPECT_EQ(keys[60].centre.z(), height);
  EXPECT_LT(keys[60].time, keys[61].time);
  EXPECT_NEAR(keys[60].time, keys[61].time, 1e-6);
}

TEST_F(ClipTest, ABodyThatIsBuiltIsCutWhereItsVerticesChange) {
  Open("sandbox");
  ground->Take(server::JoinEntry{1, false, "Ada"});
  Play(30);
  const physics::BodyId body = ground->ReadWorkshop()->Body();
  const std::size_t vertices = ground->World().BlueprintOf(ground->World().ReadBody(body)).rest.size();
  server::BuildCommand build{.kind = server::BuildCommand::Kind::kAddParticle};
  build.at = ground->World().FindCentre(ground->World().ReadBody(body)) + physics::Vector3d(0, 0, 3);
  EXPECT_EQ(ground->Take(server::ActEntry{.client = 1, .command = build}), "");
  Play(30);
  const std::vector<const Part*> parts = FindParts(body);
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0]->vertices.size(), vertices);
  EXPECT_EQ(parts[1]->vertices.size(), vertices + 1);
  EXPECT_EQ(parts[0]->span.to, parts[1]->span.from);
  EXPECT_GT(parts[0]->span.to, 0.4F);
}

TEST_F(ClipTest, ABodyThatComesAndGoesHasItsTimes) {
  Open("pair");
  Play(10);
  ground->Take(server::JoinEntry{1, false, "Ada"});
  const physics::BodyId body = ground->FindPlayer(1)->body;
  Play(10);
  ground->Take(server::LeaveEntry{1});
  Play(10);
  ASSERT_EQ(FindParts(body).size(), 1U);
  const Part& part = *FindParts(body)[0];
  EXPECT_EQ(part.player, "Ada");
  EXPECT_FLOAT_EQ(part.span.from, 10 / 60.0F);
  EXPECT_FLOAT_EQ(part.span.to, 20 / 60.0F);
  EXPECT_EQ(part.keys.size(), 10U);
}

TEST_F(ClipTest, RestCostsTwoKeysAndOneShape) {
  Open("pair");
  Frame frame{.time = 0, .tick = 0, .ground = *ground, .bodies = {&ground->World().Bodies()[0]}};
  for (int i = 0; i < 100; ++i) {
    frame.time = i;
    clip.Add(frame);
  }
  const Part& part = clip.Parts().at(0);
  EXPECT_EQ(part.keys.size(), 2U);
  EXPECT_EQ(part.keys.back().time, 99);
  EXPECT_EQ(part.shapes.size(), part.rest.size());
}

}  // namespace
}  // namespace wobble::exporting
