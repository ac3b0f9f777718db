// Scenes: the shipped ones, and the errors of files with mistakes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <set>
#include <string>

#include "server/config.h"
#include "server/scenes/loader.h"
#include "tests/support/places.h"

namespace wobble::scenes {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

const std::filesystem::path kFolder = test::FindSource("server/scenes");

const std::vector<std::string> kShipped{
    "arena",   "backtracking", "ball_drop", "breathing",   "bubble",  "cards",    "cloth",    "crowd", "crown",
    "curtain", "drop2d",       "goals",     "jelly_stack", "lattice", "magnetic", "mesh_zoo", "pair",  "perturbation",
    "pitch",   "sandbox",      "scrum",     "solids",      "sumo",    "tension",  "wind"};

#ifdef WOBBLE_SANITIZED
constexpr int kTicks = 30;  // 34 times slower there
#else
constexpr int kTicks = 300;
#endif

// A scene without mistakes. `extra` goes in front, among the fields of the scene itself.
std::string MakeText(const std::string& extra, const std::string& blueprintExtra = "", const std::string& tail = "") {
  return extra + "\n[[blueprint]]\nname = \"ball\"\nsubdivisions = 1\n" + blueprintExtra +
         "\n[player]\nblueprint = \"ball\"\n" + tail;
}

std::vector<std::string> ErrorsOf(const std::string& text) { return ParseScene(text, "test.toml").errors; }

class ShippedScene : public testing::TestWithParam<std::string> {
 protected:
  static std::uint64_t PlayAndHash(const Scene& scene, std::uint64_t seed) {
    physics::World world(MakeWorldSettings(scene, 1.0 / 60, 1));
    const auto placed = FillWorld(scene, seed, world);
    EXPECT_EQ(placed.size(), CountBodies(scene));
    EXPECT_EQ(world.Bodies().size(), CountBodies(scene));
    EXPECT_EQ(world.Obstacles().size(), scene.obstacles.size());
    EXPECT_EQ(world.Blueprints().size(), scene.blueprints.size());
    for (int tick = 0; tick < 5; ++tick) world.Step();
    return world.Hash();
  }
};

TEST_P(ShippedScene, LoadsAndMakesAWorld) {
  const LoadResult loaded = LoadScene(GetParam(), kFolder);
  ASSERT_THAT(loaded.errors, IsEmpty());
  EXPECT_EQ(loaded.scene.name, GetParam());
  EXPECT_FALSE(loaded.scene.description.empty());
  EXPECT_THAT(server::Validate({}, loaded.scene), IsEmpty());
  const std::uint64_t hash = PlayAndHash(loaded.scene, 1);
  EXPECT_EQ(PlayAndHash(loaded.scene, 1), hash);
  // Only groups with jitter can differ between seeds.
  bool hasJitter = false;
  for (const BodyGroup& group : loaded.scene.groups) hasJitter = hasJitter || group.jitter > 0;
  EXPECT_EQ(PlayAndHash(loaded.scene, 2) != hash, hasJitter);
}
// Steps the scene with a player who runs, jumps and puffs up.
TEST_P(ShippedScene, LosesNobody) {
  const Scene scene = LoadScene(GetParam(), kFolder).scene;
  physics::World world(MakeWorldSettings(scene, 1.0 / 60, 1));
  static_cast<void>(FillWorld(scene, 1, world));
  const auto player =
      world.AddBody(static_cast<std::uint8_t>(scene.player.blueprint), FindFreeSpawn(scene.player, 1, world));
  for (int tick = 0; tick < kTicks; ++tick) {
    physics::Control control;
    control.moveX = tick % 120 < 60 ? 1 : -1;
    control.jump = tick % 45 == 40;
    control.puff = tick % 100 > 70;
    world.SetControl(player, control, scene.player.limits);
    const physics::StepReport report = world.Step();
    ASSERT_EQ(report.nonFinite, 0U) << "tick " << tick;
    ASSERT_EQ(report.inverted, 0U) << "tick " << tick;
    ASSERT_EQ(report.quarantined, 0U) << "tick " << tick;
  }
}
INSTANTIATE_TEST_SUITE_P(All, ShippedScene, testing::ValuesIn(kShipped),
                         [](const auto& parameter) { return parameter.param; });

TEST(Scenes, TheShippedOnesAreListed) {
  std::vector<std::string> names;
  for (const SceneSummary& scene : ListScenes(kFolder)) {
    names.push_back(scene.name);
    EXPECT_FALSE(scene.description.empty());
    EXPECT_THAT(scene.description, testing::Not(HasSubstr("has errors")));
  }
  EXPECT_THAT(names, testing::ElementsAreArray(kShipped));
}

TEST(Scenes, ObstaclesOfEveryKind) {
  const LoadResult loaded = ParseScene(MakeText("", "", R"(
[[obstacle]]
kind = "sphere"
center = [1, 2, 3]
radius = 4
[[obstacle]]
kind = "capsule"
from = [1, 2, 3]
to = [4, 5, 6]
radius = 0.5
friction = 0.25
[[obstacle]]
kind = "height_field"
position = [-1, -1, 5]
cell_size = 2
heights = [[0, 1, 2], [0.5, 1.5, 2.5]]
)"),
                                       "test.toml");
  ASSERT_THAT(loaded.errors, IsEmpty());
  ASSERT_EQ(loaded.scene.obstacles.size(), 3U);
  const physics::Obstacle& sphere = loaded.scene.obstacles[0];
  EXPECT_EQ(sphere.kind, physics::Obstacle::Kind::kSphere);
  EXPECT_EQ(sphere.centre, physics::Vector3d(1, 2, 3));
  EXPECT_EQ(sphere.radius, 4);
  const physics::Obstacle& capsule = loaded.scene.obstacles[1];
  EXPECT_EQ(capsule.kind, physics::Obstacle::Kind::kCapsule);
  EXPECT_EQ(capsule.end, physics::Vector3d(4, 5, 6));
  EXPECT_EQ(capsule.friction, 0.25);
  const physics::Obstacle& ground = loaded.scene.obstacles[2];
  EXPECT_EQ(ground.centre, physics::Vector3d(-1, -1, 5));
  ASSERT_NE(ground.field, nullptr);
  EXPECT_EQ(ground.field->columns, 3);
  EXPECT_EQ(ground.field->rows, 2);
  EXPECT_NEAR(physics::FindHeight(*ground.field, 4, 2), 2.5, 1e-12) << "x is along a row";
  EXPECT_NEAR(physics::FindHeight(*ground.field, 2, 0), 1, 1e-12);
}

TEST(Scenes, MistakesInObstaclesAreNamed) {
  const auto errors = ErrorsOf(MakeText("", "", R"(
[[obstacle]]
kind = "sphere"
radius = 0.01
[[obstacle]]
kind = "capsule"
from = [1, 2]
[[obstacle]]
kind = "height_field"
cell_size = 0
heights = [[0, 1], [2]]
[[obstacle]]
kind = "height_field"
heights = [[0, 1], [2, nan]]
[[obstacle]]
kind = "height_field"
heights = [[0, 1]]
[[obstacle]]
kind = "height_field"
)"));
  EXPECT_THAT(errors,
              ElementsAre(AllOf(HasSubstr("radius = 0.01"), HasSubstr("0.1 to 1000 m")), HasSubstr("to is missing"),
                          AllOf(HasSubstr("from = [ 1, 2 ]"), HasSubstr("three")),
                          AllOf(HasSubstr("cell_size = 0"), HasSubstr("0.05 to 100 m")),
                          AllOf(HasSubstr("heights = [ 2 ]"), HasSubstr("as many numbers each")),
                          AllOf(HasSubstr("heights = nan"), HasSubstr("-1000 to 1000 m")),
                          AllOf(HasSubstr("heights = "), HasSubstr("2 to 128 rows")), HasSubstr("heights is missing")));
}

TEST(Scenes, IntegratorsAreTheScenesOrTheBlueprintsOwn) {
  using physics::Integrator;
  EXPECT_EQ(ParseScene(MakeText(""), "test.toml").scene.methods[0].integrator, Integrator::kRungeKutta4);
  const std::string another = "[[blueprint]]\nname = \"other\"\nintegrator = \"implicit_euler\"\n";
  const LoadResult loaded = ParseScene(MakeText("integrator = \"leap_frog\"", "", another), "test.toml");
  ASSERT_THAT(loaded.errors, IsEmpty());
  physics::World world{physics::WorldSettings{}};
  const auto placed = FillWorld(loaded.scene, 1, world);
  EXPECT_EQ(world.Blueprints()[0].integrator, Integrator::kLeapFrog);
  EXPECT_EQ(world.Blueprints()[1].integrator, Integrator::kImplicitEuler);
  EXPECT_NE(world.Blueprints()[1].sparsePattern, nullptr);
  EXPECT_THAT(ErrorsOf(MakeText("integrator = \"magic\"")),
              ElementsAre(AllOf(StartsWith("test.toml:1: integrator"), HasSubstr("explicit_euler"), HasSubstr("rk4"))));
}

TEST(Scenes, ContactLawsAreTheBlueprintsOwn) {
  using physics::ContactLaw;
  const std::string another = "[[blueprint]]\nname = \"other\"\ncontact_law = \"magnetic\"\nmagnetic_strength = 0.5\n";
  const LoadResult loaded = ParseScene(MakeText("", "contact_law = \"backtracking\"", another), "test.toml");
  ASSERT_THAT(loaded.errors, IsEmpty());
  physics::World world{physics::WorldSettings{}};
  const auto placed = FillWorld(loaded.scene, 1, world);
  EXPECT_EQ(world.Blueprints()[0].full.contact.law, ContactLaw::kBacktracking);
  EXPECT_EQ(world.Blueprints()[1].single.contact.law, ContactLaw::kMagnetic);
  EXPECT_EQ(world.Blueprints()[1].single.contact.strength, 0.5F);
  EXPECT_THAT(ErrorsOf(MakeText("", "contact_law = \"sticky\"")),
              ElementsAre(AllOf(HasSubstr("contact_law"), HasSubstr("backtracking, magnetic, penalty"))));
  EXPECT_THAT(ErrorsOf(MakeText("", "contact_law = \"magnetic\"\nmagnetic_strength = 0")),
              ElementsAre(HasSubstr("magnetic_strength = 0: must be 1e-07 to 100 N·m²")));
  EXPECT_THAT(ErrorsOf(MakeText("", "magnetic_strength = 0.1")),
              ElementsAre(HasSubstr("magnetic_strength = 0.1: must be left out unless")));
}

TEST(Scenes, WhatTheyAreMeantToBe) {
  const Scene arena = LoadScene("arena", kFolder).scene;
  EXPECT_EQ(arena.obstacles.size(), 5U);
  EXPECT_GT(arena.killHeight, -50);
  const Scene crowd = LoadScene("crowd", kFolder).scene;
  EXPECT_EQ(CountBodies(crowd), 1000U);
  EXPECT_EQ(CountVertices(crowd.blueprints[crowd.groups[0].blueprint]), 162U);
  // LoadsAndMakesAWorld compares equal and different seeds.
  EXPECT_GT(crowd.groups[0].jitter, 0);
  const Scene stack = LoadScene("jelly_stack", kFolder).scene;
  ASSERT_EQ(CountBodies(stack), 8U);
  const auto& slab = std::get<physics::LatticeDefinition>(stack.blueprints[stack.groups[0].blueprint]);
  // As one column it must not buckle under its own weight (Greenhill 1881): ρ g A H³ < 7.84 E I, here with a margin of
  // half.
  const double width = slab.cells[0] * slab.cellSize;
  const double height = 8 * slab.cells[2] * slab.cellSize;
  const double load = 12 * slab.density * 9.81 * std::pow(height, 3) / (slab.youngModulus * width * width);
  EXPECT_LT(load, 0.5 * 7.84);
}

TEST(Scenes, PlayersStartApart) {
  PlayerRules rules;
  rules.spawnRadius = 5;
  for (std::uint32_t i = 1; i <= 32; ++i) {
    for (std::uint32_t j = 1; j < i; ++j) {
      EXPECT_GT((FindSpawn(rules, i) - FindSpawn(rules, j)).norm(), 0.5) << i << " and " << j;
    }
  }
}

TEST(SceneMistakes, ThreeAreThreeLinesEachWithLineValueAndRange) {
  const auto errors = ErrorsOf(R"(kill_height = -9999
[[obstacle]]
kind = "torus"
[[blueprint]]
name = "ball"
mass = -1
[player]
blueprint = "ball"
)");
  ASSERT_EQ(errors.size(), 3U) << testing::PrintToString(errors);
  EXPECT_THAT(errors[0],
              AllOf(StartsWith("test.toml:1: "), HasSubstr("kill_height = -9999"), HasSubstr("-4000 to 4000")));
  EXPECT_THAT(errors[1], AllOf(StartsWith("test.toml:3: "), HasSubstr("kind = "), HasSubstr("torus"), HasSubstr("box"),
                               HasSubstr("plane")));
  EXPECT_EQ(errors[2], "test.toml:6: mass = -1: must be 0.001 to 1000000 kg");
  for (const std::string& error : errors) EXPECT_EQ(error.find('\n'), std::string::npos);
}

TEST(SceneMistakes, NoneAreNone) { EXPECT_THAT(ErrorsOf(MakeText("gravity = [0, 0, -9.81]")), IsEmpty()); }

TEST(SceneMistakes, UnknownKeysAreNamedWithThoseThatAreKnown) {
  EXPECT_THAT(ErrorsOf(MakeText("gravitation = 3")),
              ElementsAre(AllOf(StartsWith("test.toml:1: gravitation"), HasSubstr("gravity"))));
  EXPECT_THAT(ErrorsOf(MakeText("", "colour = \"red\"\n")),
              ElementsAre(AllOf(StartsWith("test.toml:5: colour"), HasSubstr("friction"))));
  EXPECT_THAT(ErrorsOf(MakeText("", "", "spawn_radios = 4\n")),
              ElementsAre(AllOf(StartsWith("test.toml:8: spawn_radios"), HasSubstr("spawn_radius"))));
}

TEST(SceneMistakes, WrongTypesAreNamed) {
  EXPECT_THAT(ErrorsOf(MakeText("gravity = 9.81")),
              ElementsAre(AllOf(HasSubstr(":1: gravity = 9.81"), HasSubstr("three numbers"))));
  EXPECT_THAT(ErrorsOf(MakeText("gravity = [0, \"down\", 1]")), ElementsAre(HasSubstr("three numbers")));
  EXPECT_THAT(ErrorsOf(MakeText("description = 5")),
              ElementsAre(AllOf(HasSubstr("description = 5"), HasSubstr("text"))));
  EXPECT_THAT(ErrorsOf(MakeText("kill_height = \"low\"")),
              ElementsAre(AllOf(HasSubstr("kill_height = "), HasSubstr("low"), HasSubstr("-4000 to 4000 m"))));
  EXPECT_THAT(ErrorsOf(MakeText("kill_height = true")), ElementsAre(HasSubstr("kill_height = true")));
  EXPECT_THAT(ErrorsOf(MakeText("kill_height = nan")), ElementsAre(HasSubstr("-4000 to 4000")));
  EXPECT_THAT(ErrorsOf(MakeText("obstacle = 4")), ElementsAre(AllOf(HasSubstr("obstacle = 4"), HasSubstr("table"))));
  // Quantities of a blueprint, with the ranges of the physics.
  EXPECT_THAT(ErrorsOf(MakeText("", "mass = \"heavy\"\n")),
              ElementsAre(AllOf(StartsWith("test.toml:5: mass = "), HasSubstr("heavy"),
                                HasSubstr("a number, 0.001 to 1000000 kg"))));
  EXPECT_THAT(ErrorsOf(MakeText("", "friction = 1e300\n")), ElementsAre(HasSubstr("0 to 10")));
}

TEST(SceneMistakes, CountsAreWholeNumbers) {
  const std::string group = "[[bodies]]\nblueprint = \"ball\"\ncount = ";
  EXPECT_THAT(ErrorsOf(MakeText("", "", group + "[2, 1.5, 1]\n")),
              ElementsAre(AllOf(HasSubstr("count"), HasSubstr("whole"))));
  EXPECT_THAT(ErrorsOf(MakeText("", "", group + "[0, 1, 1]\n")), ElementsAre(HasSubstr("1 to 1000")));
  EXPECT_THAT(ErrorsOf(MakeText("", "", group + "[1000, 1000, 1000]\n")), ElementsAre(HasSubstr("at most 20000")));
  EXPECT_THAT(ErrorsOf(MakeText("", "", group + "[3, 2, 1]\n")), IsEmpty());
}

TEST(SceneMistakes, NamesThatDoNotExistAreAnsweredWithThoseThatDo) {
  EXPECT_THAT(ErrorsOf("[[blueprint]]\nname = \"ball\"\n[player]\nblueprint = \"bal\"\n"),
              ElementsAre(AllOf(StartsWith("test.toml:4: "), HasSubstr("bal"), HasSubstr("one of: ball"))));
  EXPECT_THAT(ErrorsOf(MakeText("", "[[blueprint]]\nname = \"ball\"\n")), ElementsAre(HasSubstr("no other blueprint")));
}

TEST(SceneMistakes, WhatIsNeededAndMissingIsNamed) {
  const auto errors = ErrorsOf("description = \"nothing\"\n");
  EXPECT_THAT(errors, testing::UnorderedElementsAre(HasSubstr("blueprint is missing"), HasSubstr("player is missing")));
}

TEST(SceneMistakes, ABallThatCannotBeBuiltIsRefusedWithItsBound) {
  EXPECT_THAT(ErrorsOf(MakeText("", "mass = 20\ngas = 98\n")),
              ElementsAre(AllOf(StartsWith("test.toml:6: gas = 98"), HasSubstr("98.1 J"))));
  EXPECT_THAT(ErrorsOf(MakeText("", "mass = 20\ngas = 98.2\n")), IsEmpty());
  EXPECT_THAT(ErrorsOf(MakeText("", "gas = 1e6\n")),
              ElementsAre(AllOf(StartsWith("test.toml:5: gas"), HasSubstr("at most"))));
}

TEST(SceneMistakes, EachKindOfBlueprintHasItsOwnFields) {
  const auto errorsOf = [](const std::string& fields) {
    return ErrorsOf("[[blueprint]]\nname = \"cube\"\n" + fields + "[player]\nblueprint = \"cube\"\n");
  };
  EXPECT_THAT(errorsOf("kind = \"lattice\"\ncells = [2, 2, 4]\ncell_size = 0.2\nyoung_modulus = 1e4\n"
                       "poisson_ratio = 0.25\ndensity = 30\n"),
              IsEmpty());
  EXPECT_THAT(errorsOf("kind = \"lattice\"\ngas = 3\n"),
              ElementsAre(AllOf(StartsWith("test.toml:4: gas is no field here"), HasSubstr("young_modulus"))));
  EXPECT_THAT(errorsOf("cells = [2, 2, 2]\n"),
              ElementsAre(AllOf(StartsWith("test.toml:3: cells is no field here"), HasSubstr("subdivisions"))));
  EXPECT_THAT(errorsOf("kind = \"jelly\"\nanything = 1\n"),
              ElementsAre(AllOf(StartsWith("test.toml:3: kind = "),
                                HasSubstr("one of: ball, cloth, graph, lattice, mesh, pair, ring, solid"))));
  EXPECT_THAT(
      errorsOf("kind = \"lattice\"\npoisson_ratio = 0.4\n"),
      ElementsAre("test.toml:4: poisson_ratio = 0.4: must be 0.25: a lattice of central springs has no other in "
                  "3-D"));
  EXPECT_THAT(errorsOf("kind = \"lattice\"\ncells = [2, 2.5, 2]\n"),
              ElementsAre(AllOf(HasSubstr("cells = "), HasSubstr("three whole numbers from 0 to 100"))));
  EXPECT_THAT(errorsOf("kind = \"lattice\"\ncells = [40, 40, 40]\n"),
              ElementsAre(AllOf(HasSubstr("68921 vertices"), HasSubstr("at most 10000"))));
  EXPECT_THAT(errorsOf("kind = \"lattice\"\nyoung_modulus = \"soft\"\n"),
              ElementsAre(AllOf(HasSubstr("soft"), HasSubstr("a number, above 0, up to 1e12 Pa"))));
}

std::vector<std::string> ErrorsOfBlueprint(const std::string& fields) {
  return ErrorsOf("[[blueprint]]\nname = \"it\"\n" + fields + "[player]\nblueprint = \"it\"\n");
}

TEST(SceneMistakes, ASolidIsABoxOrWhatAMeshEnclosesAndIsSteppedByAnExplicitMethod) {
  const std::string solid = "kind = \"solid\"\n";
  EXPECT_THAT(ErrorsOfBlueprint(solid), IsEmpty());
  EXPECT_THAT(
      ErrorsOfBlueprint(solid + "cells = [2, 2, 3]\ncell_size = 0.2\nyoung_modulus = 2e4\npoisson_ratio = 0.45\n"
                                "density = 30\ndamping_ratio = 0.2\nfriction = 0.5\nfixed = \"z-\"\n"
                                "integrator = \"velocity_verlet\"\n"),
      IsEmpty());
  EXPECT_THAT(ErrorsOfBlueprint(solid + "poisson_ratio = 0.5\n"),
              ElementsAre("test.toml:4: poisson_ratio = 0.5: must be 0 to 0.45"));
  EXPECT_THAT(ErrorsOfBlueprint(solid + "scale = 2\n"), ElementsAre(HasSubstr("left out unless there is a file")));
  EXPECT_THAT(ErrorsOfBlueprint(solid + "cells = [2, 0, 2]\n"), ElementsAre(HasSubstr("whole numbers from 1 to 100")));
  EXPECT_THAT(ErrorsOfBlueprint(solid + "file = \"missing.obj\"\n"), ElementsAre(HasSubstr("cannot be read")));
  for (const std::string method : {"implicit_euler", "position_verlet"}) {
    EXPECT_THAT(ErrorsOfBlueprint(solid + "integrator = \"" + method + "\"\n"),
                ElementsAre(AllOf(StartsWith("test.toml:4: integrator = "), HasSubstr("know springs"))));
  }
}

TEST(SceneMistakes, APlanarLatticeHasItsOwnPoissonRatioAndSides) {
  const std::string planar = "kind = \"lattice\"\ncells = [4, 0, 3]\n";
  EXPECT_THAT(ErrorsOfBlueprint(planar + "fixed = \"z+\"\n"), IsEmpty());
  EXPECT_THAT(ErrorsOfBlueprint(planar + "poisson_ratio = 0.3333\n"), IsEmpty());
  EXPECT_THAT(ErrorsOfBlueprint(planar + "poisson_ratio = 0.25\n"),
              ElementsAre(AllOf(StartsWith("test.toml:5: poisson_ratio = 0.25"), HasSubstr("1/3"), HasSubstr("2-D"))));
  EXPECT_THAT(ErrorsOfBlueprint(planar + "fixed = \"y-\"\n"),
              ElementsAre(AllOf(StartsWith("test.toml:5: fixed = "), HasSubstr("y-"), HasSubstr("x-, x+, z-, z+"))));
  EXPECT_THAT(ErrorsOfBlueprint(planar + "fixed = \"top\"\n"),
              ElementsAre(AllOf(HasSubstr("top"), HasSubstr("one of: none, x+, x-"))));
  EXPECT_THAT(ErrorsOfBlueprint("kind = \"lattice\"\ncells = [0, 3, 3]\n"),
              ElementsAre(AllOf(StartsWith("test.toml:4: cells = "), HasSubstr("the second 0: a planar lattice"))));
}

TEST(SceneMistakes, APairHasLengthAndMaterial) {
  EXPECT_THAT(ErrorsOfBlueprint("kind = \"pair\"\nlength = 0.8\nmass = 3\nstiffness = 40\ndamping_ratio = 0.05\n"
                                "direction = [0, 0, 1]\nfirst_is_fixed = true\n"),
              IsEmpty());
  EXPECT_THAT(ErrorsOfBlueprint("kind = \"pair\"\nlength = 0\ndirection = [0, 0, 0]\nfirst_is_fixed = 1\n"),
              ElementsAre(AllOf(HasSubstr(":4: length = 0"), HasSubstr("0.02 to 50 m")),
                          AllOf(HasSubstr(":5: direction"), HasSubstr("a direction")),
                          AllOf(HasSubstr(":6: first_is_fixed = 1"), HasSubstr("true or false"))));
}

TEST(SceneMistakes, ARingHasPointsLayersAndGas) {
  EXPECT_THAT(
      ErrorsOfBlueprint(
          "kind = \"ring\"\npoints = 30\nlayers = 3\nradius = 0.6\nthickness = 0.2\ngas = 40\nstiffness = 2000\n"),
      IsEmpty());
  EXPECT_THAT(ErrorsOfBlueprint("kind = \"ring\"\npoints = 2\nlayers = 1.5\ngas = 0\n"),
              ElementsAre(AllOf(HasSubstr(":4: points = 2"), HasSubstr("whole number from 3 to 512")),
                          AllOf(HasSubstr(":5: layers = 1.5"), HasSubstr("whole number from 1 to 8")),
                          AllOf(HasSubstr(":6: gas = 0"), HasSubstr("held open"))));
}

TEST(SceneMistakes, AClothHasPointsPinsAndATearStretch) {
  EXPECT_THAT(
      ErrorsOfBlueprint("kind = \"cloth\"\npoints = [12, 8]\nspacing = 0.2\norientation = \"horizontal\"\n"
                        "pinned = \"frame\"\nshear = 0.4\nbend = 0.05\ntear_stretch = 1.6\nmass = 2\ndrag = 0.6\n"),
      IsEmpty());
  EXPECT_THAT(ErrorsOfBlueprint("kind = \"cloth\"\npoints = [12, 8, 3]\npinned = \"left\"\ntear_stretch = \"no\"\n"),
              ElementsAre(AllOf(HasSubstr(":4: points = "), HasSubstr("two whole numbers from 2 to 100")),
                          AllOf(HasSubstr(":5: pinned = "),
                                HasSubstr("one of: clamp, corners, edge, frame, none, top_corners")),
                          AllOf(HasSubstr(":6: tear_stretch = "), HasSubstr("a number, 0 (never) or 1.05 to 10"))));
}

TEST(SceneMistakes, AClothThatResistsBendingIsSteppedByAnExplicitMethod) {
  const std::string card = "kind = \"cloth\"\nbend_stiffness = 0.3\n";
  EXPECT_THAT(ErrorsOfBlueprint(card + "bend = 0\npinned = \"clamp\"\nintegrator = \"velocity_verlet\"\n"), IsEmpty());
  EXPECT_THAT(ErrorsOfBlueprint("kind = \"cloth\"\nbend_stiffness = -1\n"),
              ElementsAre("test.toml:4: bend_stiffness = -1: must be 0 to 1e6 J"));
  EXPECT_THAT(ErrorsOfBlueprint("kind = \"cloth\"\nbend_stiffness = 80\n"),
              ElementsAre(AllOf(StartsWith("test.toml:4: bend_stiffness = 80: must be lower"))));
  for (const std::string method : {"implicit_euler", "position_verlet"}) {
    EXPECT_THAT(ErrorsOfBlueprint(card + "integrator = \"" + method + "\"\n"),
                ElementsAre(AllOf(StartsWith("test.toml:5: integrator = "), HasSubstr("not bend_stiffness"))));
    EXPECT_THAT(ErrorsOfBlueprint("kind = \"cloth\"\nintegrator = \"" + method + "\"\n"), IsEmpty());
  }
}

TEST(SceneMistakes, AGraphListsParticlesAndSprings) {
  const std::string graph = R"(kind = "graph"
planar = true
particle = [{ position = [0, 0, 2], mass = 2, fixed = true }, { position = [1, 0, 2] }]
)";
  EXPECT_THAT(
      ErrorsOfBlueprint(graph + "spring = [{ ends = [0, 1], stiffness = 40, damping = 0.5, rest_length = 0.8 }]\n"),
      IsEmpty());
  EXPECT_THAT(ErrorsOfBlueprint("kind = \"graph\"\n"), ElementsAre(HasSubstr("particles = 0.0: must be at least 1")));
  EXPECT_THAT(ErrorsOfBlueprint(graph + "spring = [{ ends = [0, 1] }, { ends = [1, 0] }, { ends = [0, 2] },\n"
                                        "  { stiffness = -1 }]\n"),
              testing::UnorderedElementsAre(AllOf(StartsWith("test.toml:7: stiffness = -1"), HasSubstr("1e+09 N/m")),
                                            AllOf(StartsWith("test.toml:7: ends is missing")),
                                            AllOf(HasSubstr("spring[1].ends = [1, 0]"), HasSubstr("no spring joins")),
                                            AllOf(HasSubstr("spring[2].ends = [0, 2]"), HasSubstr("from 0 to 1")),
                                            AllOf(HasSubstr("spring[3].ends = [0, 1]"), HasSubstr("no spring joins"))));
}

TEST(SceneMistakes, ASyntaxErrorHasItsLine) {
  EXPECT_THAT(ErrorsOf("description = \"a\"\n\nkill_height = = 3\n"), ElementsAre(StartsWith("test.toml:3: ")));
  EXPECT_THAT(ErrorsOf("[[blueprint]\n"), ElementsAre(StartsWith("test.toml:1: ")));
}

TEST(SceneMistakes, AnUnknownSceneListsTheKnownOnes) {
  const LoadResult loaded = LoadScene("arina", kFolder);
  EXPECT_THAT(
      loaded.errors,
      ElementsAre(AllOf(HasSubstr("'arina'"),
                        HasSubstr("arena, backtracking, ball_drop, breathing, bubble, cards, cloth, crowd, "))));
  EXPECT_THAT(LoadScene("/nowhere/at/all.toml", kFolder).errors, ElementsAre(HasSubstr("/nowhere/at/all.toml")));
}

// Found by fuzzing: to build the ball first took seconds, and minutes under sanitizers.
TEST(SceneLimits, ABallThatIsTooFineIsRefusedAtOnce) {
  for (const std::string subdivisions : {"5", "99", "-1"}) {
    const std::string text = "[[blueprint]]\nname = \"ball\"\nsubdivisions = " + subdivisions + "\n";
    EXPECT_THAT(ParseScene(text, "test").errors,
                Contains(AllOf(HasSubstr("subdivisions"), HasSubstr(subdivisions), HasSubstr("0 to 4"))));
  }
}

TEST(SceneLimits, WhatTheProtocolCannotCarryIsRefusedWithBothNumbers) {
  // Not parsed, because the loader would build the ball to check its material, which takes long in a sanitizer build.
  Scene scene;
  scene.name = "test";
  physics::BallDefinition ball;
  ball.subdivisions = 5;
  scene.blueprints.push_back(ball);
  EXPECT_THAT(server::Validate({}, scene), ElementsAre(AllOf(HasSubstr("10242"), HasSubstr("4096"))));

  server::Config config;
  config.tickHz = 5;
  config.snapshotHz = 6;
  config.clientKbit = 1;
  EXPECT_THAT(server::Validate(config, LoadScene("arena", kFolder).scene),
              ElementsAre("--tick-hz 5: must be 10 to 480", "--snapshot-hz 6: must be 1 to 5",
                          "--client-kbit 1: must be 32 to 100000"));
  config = {.afterMatch = server::AfterMatch::kRestart};
  EXPECT_THAT(server::Validate(config, LoadScene("sumo", kFolder).scene),
              ElementsAre("--after-match restart: --rounds must say how many rounds make a match"));
}

// A crowd joins at once, on a circle with room for few of them.
TEST(Spawn, NobodyIsPutIntoAnother) {
  physics::World world(physics::WorldSettings{});
  world.AddBlueprint(physics::MakeBall(physics::BallDefinition{}));
  PlayerRules rules;
  rules.spawnRadius = 3;
  for (std::uint32_t i = 1; i <= 100; ++i) world.AddBody(0, FindFreeSpawn(rules, i, world));
  for (const physics::Body& one : world.Bodies()) {
    for (const physics::Body& other : world.Bodies()) {
      if (one.id < other.id) {
        EXPECT_GT((world.FindCentre(one) - world.FindCentre(other)).norm(), 1);
      }
    }
  }
}

}  // namespace
}  // namespace wobble::scenes
