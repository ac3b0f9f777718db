// Drives of a scene, and the stretch with which its bodies start.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "server/scenes/loader.h"

namespace wobble::scenes {
namespace {

using physics::Vector3d;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

// A scene without gravity; `tail` begins in line 13.
std::string MakeTextWithDrives(const std::string& tail) {
  return R"(gravity = [0, 0, 0]
[[blueprint]]
name = "ball"
subdivisions = 1
[[blueprint]]
name = "bar"
kind = "lattice"
cells = [4, 1, 1]
[player]
blueprint = "ball"


)" + tail;
}

LoadResult ParseDrives(const std::string& tail) { return ParseScene(MakeTextWithDrives(tail), "test.toml"); }
std::vector<std::string> ErrorsOfDrives(const std::string& tail) { return ParseDrives(tail).errors; }

struct Played {
  physics::World world;
  std::vector<PlacedBody> placed;

  explicit Played(const std::string& tail) : world(MakeWorldSettings(ParseDrives(tail).scene, 1.0 / 60, 1)) {
    const LoadResult loaded = ParseDrives(tail);
    EXPECT_THAT(loaded.errors, IsEmpty());
    placed = FillWorld(loaded.scene, 1, world);
  }
  [[nodiscard]] Vector3d Centre(std::size_t body) const { return world.FindCentre(world.Bodies()[body]); }
  [[nodiscard]] Vector3d Extent(std::size_t body) const {
    Vector3d low = Vector3d::Constant(1e9), high = -low;
    physics::VisitVertices(world.Bodies()[body], [&](std::size_t /*index*/, const Vector3d& place) {
      low = low.cwiseMin(place);
      high = high.cwiseMax(place);
    });
    return high - low;
  }
  void Step(int ticks) {
    for (int i = 0; i < ticks; ++i) world.Step();
  }
};

TEST(SceneDrives, AForcePullsAtASideOfEachBodyOfTheBlueprint) {
  // 16 N at the far ends of both bars, 0.5 m a side and 20 kg/m³: 1.25 kg that gain 12.8 m/s each second.
  const std::string tail = R"([[bodies]]
blueprint = "bar"
count = [1, 2, 1]
spacing = [0, 5, 0]
[[bodies]]
blueprint = "ball"
position = [0, 20, 0]
[[drive]]
blueprint = "bar"
side = "x+"
force = [16, 0, 0]
begin = 0.25
end = 0.5
period = 100
)";
  Played played(tail);
  const Vector3d before[] = {played.Centre(0), played.Centre(1), played.Centre(2)};
  const double length = played.Extent(0).x();
  played.Step(15);
  EXPECT_LT((played.Centre(0) - before[0]).norm(), 1e-5) << "not before its time";
  played.Step(15);
  const double mass = played.world.Blueprints()[1].totalMass;
  for (const int bar : {0, 1}) {
    EXPECT_NEAR(played.Centre(bar).x() - before[bar].x(), 0.5 * 16 / mass * 0.25 * 0.25, 0.01);
    EXPECT_GT(played.Extent(bar).x(), 1.001 * length) << "pulled at its end, it is longer";
  }
  EXPECT_LT((played.Centre(2) - before[2]).norm(), 1e-5) << "no body of that blueprint";
  const Vector3d then = played.Centre(0);
  played.Step(30);
  EXPECT_NEAR(played.Centre(0).x() - then.x(), 16 / mass * 0.25 * 0.5, 0.02) << "on without a force";
}

TEST(SceneDrives, ASideIsAFlatEndOrACap) {
  using physics::Side;
  const Scene scene = ParseDrives("").scene;
  physics::World world(physics::WorldSettings{});
  static_cast<void>(FillWorld(scene, 1, world));
  const auto& ball = world.Blueprints()[0].rest;
  const auto& bar = world.Blueprints()[1].rest;
  for (const Side side : {Side::kLowX, Side::kHighX}) {
    const auto end = FindSide(scene.blueprints[1], bar, side);
    ASSERT_EQ(end.size(), 4U);
    for (const auto vertex : end) EXPECT_NEAR(bar[vertex].x(), side == Side::kHighX ? 0.5 : -0.5, 1e-9);
  }
  EXPECT_EQ(FindSide(scene.blueprints[1], bar, Side::kLowY).size(), 10U);
  EXPECT_EQ(FindSide(scene.blueprints[1], bar, Side::kNone).size(), bar.size());
  const auto cap = FindSide(scene.blueprints[0], ball, Side::kHighZ);
  EXPECT_GE(cap.size(), 1U);
  EXPECT_LE(cap.size(), 8U);
  for (const auto vertex : cap) EXPECT_GT(ball[vertex].z(), 0.75 * 0.5);
}

TEST(SceneDrives, GasAndWindComeAndGo) {
  Played breathing(
      "[[bodies]]\nblueprint = \"ball\"\n[[bodies]]\nblueprint = \"bar\"\nposition = [0, 5, 0]\n"
      "[[drive]]\nblueprint = \"ball\"\ngas = 2\nend = 0.5\nperiod = 100\n");
  const double width = breathing.Extent(0).x();
  breathing.Step(30);
  EXPECT_GT(breathing.Extent(0).x(), 1.05 * width);
  breathing.Step(600);
  EXPECT_NEAR(breathing.Extent(0).x(), width, 0.01 * width);
  // The balls of this scene have no drag; a body with drag goes with the wind, also a player's.
  const std::string leaf =
      "[[blueprint]]\nname = \"leaf\"\nsubdivisions = 1\ndrag = 0.6\n[[bodies]]\n"
      "blueprint = \"leaf\"\n[[drive]]\nwind = [5, 0, 0]\nend = 2\n";
  Played windy(leaf);
  windy.Step(60);
  EXPECT_GT(windy.Centre(0).x(), 0.05);
}

TEST(SceneDrives, BodiesAreStretchedAboutTheirCentres) {
  Played played(
      "[[bodies]]\nblueprint = \"bar\"\nposition = [1, 2, 3]\nstretch = [1.5, 1, 0.5]\nvelocity = [0, 1, 0]\n"
      "[[bodies]]\nblueprint = \"bar\"\nposition = [1, 9, 3]\n");
  EXPECT_LT((played.Centre(0) - Vector3d(1, 2, 3)).norm(), 1e-5);
  EXPECT_LT((played.Extent(0) - Vector3d(1.5, 0.25, 0.125)).norm(), 1e-5);
  EXPECT_LT((played.Extent(1) - Vector3d(1, 0.25, 0.25)).norm(), 1e-5);
  played.Step(6);
  EXPECT_NEAR(played.Centre(0).y(), 2.1, 1e-3) << "it keeps its velocity";
}

TEST(SceneDriveMistakes, EachIsNamedWithItsRange) {
  EXPECT_THAT(ErrorsOfDrives("[[drive]]\nblueprint = \"bat\"\nforce = [1, 0, 0]\n"),
              ElementsAre(AllOf(StartsWith("test.toml:14: blueprint = "), HasSubstr("one of: ball, bar"))));
  EXPECT_THAT(ErrorsOfDrives("[[drive]]\nblueprint = \"bar\"\nforce = [2e5, 0, 0]\nside = \"x\"\n"),
              ElementsAre(AllOf(HasSubstr(":15: force"), HasSubstr("-100000 to 100000 N")),
                          AllOf(HasSubstr(":16: side"), HasSubstr("one of: all, x+, x-"))));
  EXPECT_THAT(ErrorsOfDrives("[[drive]]\nblueprint = \"ball\"\ngas = 0\nwind = [0, 0, 60]\n"),
              ElementsAre(AllOf(HasSubstr(":15: gas = 0"), HasSubstr("0.1 to 10")),
                          AllOf(HasSubstr(":16: wind"), HasSubstr("-50 to 50 m/s"))));
  EXPECT_THAT(ErrorsOfDrives("[[drive]]\nwind = [1, 0, 0]\nduration = 3\n"),
              ElementsAre(AllOf(StartsWith("test.toml:15: duration is no field here"), HasSubstr("period"))));
}

TEST(SceneDriveMistakes, TimesFollowEachOther) {
  const std::string wind = "[[drive]]\nwind = [1, 0, 0]\n";
  EXPECT_THAT(ErrorsOfDrives(wind + "begin = 1\nend = 3\nperiod = 3\n"), IsEmpty());
  EXPECT_THAT(ErrorsOfDrives(wind + "begin = 1\nend = 1\n"),
              ElementsAre(HasSubstr(":16: end = 1: must be after begin")));
  EXPECT_THAT(ErrorsOfDrives(wind + "begin = 1.5\n"), ElementsAre(HasSubstr("end = 1: must be after begin")));
  EXPECT_THAT(ErrorsOfDrives(wind + "end = 3\nperiod = 2.5\n"),
              ElementsAre(HasSubstr(":16: period = 2.5: must be no less than end")));
  EXPECT_THAT(ErrorsOfDrives(wind + "end = 3\n"), ElementsAre(HasSubstr("period = 2: must be no less than end")));
  EXPECT_THAT(ErrorsOfDrives(wind + "period = 0\n"),
              testing::Contains(HasSubstr("period = 0: must be 0.0166667 to 3600 s")));
}

TEST(SceneDriveMistakes, WhatWouldDoNothingIsRefused) {
  EXPECT_THAT(ErrorsOfDrives("[[drive]]\nblueprint = \"bar\"\nend = 1.5\n"),
              ElementsAre("test.toml:13: drive = nothing: must be a force, gas or wind"));
  EXPECT_THAT(ErrorsOfDrives("[[drive]]\nforce = [1, 0, 0]\ngas = 2\n"),
              ElementsAre(AllOf(HasSubstr(":14: force = [ 1, 0, 0 ]"), HasSubstr("only wind acts on all")),
                          AllOf(HasSubstr(":15: gas = 2"), HasSubstr("only wind acts on all"))));
  EXPECT_THAT(ErrorsOfDrives("[[drive]]\nblueprint = \"bar\"\nwind = [1, 0, 0]\nside = \"x+\"\n"),
              ElementsAre(AllOf(HasSubstr(":16: side = "), HasSubstr("left out unless there is a force"))));
  EXPECT_THAT(ErrorsOfDrives("[[bodies]]\nblueprint = \"bar\"\nstretch = [1, 4, 1]\n"),
              ElementsAre(AllOf(HasSubstr("stretch = [ 1, 4, 1 ]"), HasSubstr("three numbers from 0.2 to 3"))));
}

}  // namespace
}  // namespace wobble::scenes
