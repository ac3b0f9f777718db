// wobble_world.h: what it shows is what the engine has, and wrong calls get a code and change nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "server/library/wobble_world.h"
#include "server/physics/energy.h"
#include "server/scenes/loader.h"
#include "tests/support/places.h"

namespace wobble {
namespace {

const std::string kScenes = test::FindSource("server/scenes");
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

wobble_world_options MakeOptions(const char* scene) {
  wobble_world_options options{};
  options.struct_size = sizeof options;
  options.scene = scene;
  options.folder = kScenes.c_str();
  return options;
}

template <typename Struct>
Struct Make() {
  Struct made{};
  made.struct_size = sizeof made;
  return made;
}

class WorldInterface : public testing::Test {
 protected:
  ~WorldInterface() override { wobble_world_free(world); }
  void Load(const wobble_world_options& options) {
    wobble_world_free(world);
    std::array<char, 200> message{};
    ASSERT_EQ(wobble_world_load(&options, &world, message.data(), message.size()), WOBBLE_WORLD_OK) << message.data();
  }
  std::uint64_t Hash() {
    auto info = Make<wobble_world_info>();
    EXPECT_EQ(wobble_world_read_info(world, &info), WOBBLE_WORLD_OK);
    return info.hash;
  }
  wobble_world_body Body(std::uint32_t index) {
    auto body = Make<wobble_world_body>();
    EXPECT_EQ(wobble_world_read_body(world, index, &body), WOBBLE_WORLD_OK);
    return body;
  }
  wobble_world* world = nullptr;
};

TEST_F(WorldInterface, StepsToTheBitWhatTheEngineSteps) {
  const scenes::LoadResult loaded = scenes::LoadScene("mesh_zoo", kScenes);
  physics::World plain(scenes::MakeWorldSettings(loaded.scene, 1.0 / 60, 1));
  static_cast<void>(scenes::FillWorld(loaded.scene, 7, plain));
  wobble_world_options options = MakeOptions("mesh_zoo");
  options.seed = 7;
  options.threads = 2;
  Load(options);
  auto report = Make<wobble_world_report>();
  ASSERT_EQ(wobble_world_step(world, 40, &report), WOBBLE_WORLD_OK);
  std::uint64_t substeps = 0;
  for (int i = 0; i < 40; ++i) substeps += plain.Step().substeps;
  EXPECT_EQ(report.ticks, 40U);
  EXPECT_EQ(report.substeps, substeps);
  EXPECT_EQ(Hash(), plain.Hash());
  auto energy = Make<wobble_world_energy>();
  ASSERT_EQ(wobble_world_read_energy(world, 0, &energy), WOBBLE_WORLD_OK);
  physics::Energy sum;
  std::vector<physics::Vector3d> scratch;
  for (std::uint32_t i = 0; i < plain.Bodies().size(); ++i) {
    const physics::Body& body = plain.Bodies()[i];
    sum += physics::ComputeEnergy(plain, body, scratch);
    const wobble_world_body shown = Body(i);
    ASSERT_EQ(shown.vertex_count, plain.BlueprintOf(body).rest.size());
    physics::VisitVertices(body, [&](std::size_t vertex, const physics::Vector3d& place) {
      for (int axis = 0; axis < 3; ++axis) {
        const std::size_t k = 3 * vertex + static_cast<std::size_t>(axis);
        const double local = shown.is_double ? shown.positions_double[k] : double{shown.positions_single[k]};
        EXPECT_EQ(shown.origin[axis] + local, place[axis]);
      }
    });
  }
  EXPECT_EQ(energy.kinetic, sum.kinetic);
  EXPECT_EQ(energy.gas, sum.gas);
  EXPECT_GT(energy.kinetic, 0);
}

TEST_F(WorldInterface, ForcesAddUpAndWhatIsPushedMoves) {
  wobble_world_options options = MakeOptions("ball_drop");
  options.flags = WOBBLE_WORLD_DOUBLE;
  options.tick_rate = 240;
  Load(options);
  const double none[3] = {};
  ASSERT_EQ(wobble_world_set_gravity(world, none), WOBBLE_WORLD_OK);
  const wobble_world_body body = Body(0);
  ASSERT_EQ(body.is_double, 1);
  const std::size_t count = body.vertex_count;
  const double mass = body.mass;
  std::vector<double> push(3 * count);
  for (std::size_t i = 0; i < count; ++i) push[3 * i] = 2.4 * body.masses[i];  // N: 2.4 m/s² along x
  ASSERT_EQ(wobble_world_push(world, body.body, body.vertex_count, nullptr, push.data()), WOBBLE_WORLD_OK);
  ASSERT_EQ(wobble_world_step(world, 1, nullptr), WOBBLE_WORLD_OK);
  const wobble_world_body after = Body(0);
  double momentum = 0;
  for (std::size_t i = 0; i < count; ++i) momentum += after.masses[i] * after.velocities_double[3 * i];
  EXPECT_NEAR(momentum / mass, 2.4 / 240, 1e-6);

  std::vector<double> sum(3 * count), part(3 * count), accelerations(3 * count);
  for (int kind = 0; kind < 6; ++kind) {
    auto forces = Make<wobble_world_forces>();
    forces.vertex_capacity = body.vertex_count;
    std::array<double**, 6> kinds{&forces.elastic, &forces.damping, &forces.gas,
                                  &forces.weight,  &forces.contact, &forces.other};
    *kinds[static_cast<std::size_t>(kind)] = part.data();
    forces.accelerations = accelerations.data();
    ASSERT_EQ(wobble_world_read_forces(world, body.body, &forces), WOBBLE_WORLD_OK);
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += part[i];
  }
  for (std::size_t i = 0; i < sum.size(); ++i) {
    EXPECT_NEAR(sum[i] / after.masses[i / 3], accelerations[i], 1e-6 * (1 + std::abs(accelerations[i])));
  }
}

TEST_F(WorldInterface, BodiesComeGoAndAreSet) {
  Load(MakeOptions("ball_drop"));
  auto info = Make<wobble_world_info>();
  ASSERT_EQ(wobble_world_read_info(world, &info), WOBBLE_WORLD_OK);
  EXPECT_STREQ(info.scene, "ball_drop");
  const std::uint32_t before = info.body_count;
  const std::string kind = Body(0).name;
  const double place[3] = {0, 0, 40};
  std::uint32_t added = 0;
  ASSERT_EQ(wobble_world_add_body(world, kind.c_str(), place, nullptr, &added), WOBBLE_WORLD_OK);
  const wobble_world_body body = Body(before);
  EXPECT_EQ(body.body, added);
  std::vector<double> positions(3 * body.vertex_count), velocities(3 * body.vertex_count);
  for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = body.rest[i] + (i % 3 == 2 ? 30 : 0);
  for (std::size_t i = 2; i < velocities.size(); i += 3) velocities[i] = 3;
  ASSERT_EQ(wobble_world_set_motion(world, added, body.vertex_count, positions.data(), velocities.data()),
            WOBBLE_WORLD_OK);
  const wobble_world_body moved = Body(before);
  EXPECT_NEAR(moved.origin[2] + double{moved.positions_single[2]}, positions[2], 1e-5);
  EXPECT_EQ(moved.velocities_single[2], 3);
  EXPECT_EQ(wobble_world_set_motion(world, added, body.vertex_count - 1, positions.data(), velocities.data()),
            WOBBLE_WORLD_BAD_VALUE);
  const double aside[2] = {0.6, -0.8};
  ASSERT_EQ(wobble_world_set_control(world, added, aside, WOBBLE_WORLD_PUFF), WOBBLE_WORLD_OK);
  ASSERT_EQ(wobble_world_step(world, 30, nullptr), WOBBLE_WORLD_OK);
  EXPECT_GT(Body(before).velocities_single[0], 0.1F);
  ASSERT_EQ(wobble_world_remove_body(world, added), WOBBLE_WORLD_OK);
  EXPECT_EQ(wobble_world_remove_body(world, added), WOBBLE_WORLD_BAD_BODY);
}

// The module for Python shows arrays on it: nothing that happens to a world moves the state of its bodies in memory.
TEST_F(WorldInterface, PositionsStayWhereTheyAre) {
  wobble_world_options options = MakeOptions(nullptr);
  options.text =
      "[[obstacle]]\nkind = \"plane\"\n[[blueprint]]\nname = \"cloth\"\nkind = \"cloth\"\npoints = [8, 8]\n"
      "tear_stretch = 1.05\n[player]\nblueprint = \"cloth\"\n";
  Load(options);
  std::uint32_t body = 0;
  const auto add = [&](double x, double y) {
    const double place[3] = {x, y, 3};
    ASSERT_EQ(wobble_world_add_body(world, "cloth", place, nullptr, &body), WOBBLE_WORLD_OK);
  };
  for (int i = 0; i < 3; ++i) add(3 * i, 0);
  const std::array<wobble_world_body, 3> before{Body(0), Body(1), Body(2)};
  for (int i = 0; i < 40; ++i) add(3 * i, 9);
  for (std::uint32_t each = 4; each <= body; each += 2) {
    ASSERT_EQ(wobble_world_remove_body(world, each), WOBBLE_WORLD_OK);
  }
  ASSERT_EQ(wobble_world_remove_body(world, 1), WOBBLE_WORLD_OK);
  std::mt19937_64 random(1);
  for (const auto& [number, most] : {std::pair{2U, 1e6}, std::pair{3U, 30.0}}) {  // m/s
    const wobble_world_body wild = Body(number - 2);
    std::vector<double> positions(3 * wild.vertex_count), velocities(3 * wild.vertex_count);
    std::uniform_real_distribution<double> speed(-most, most);
    for (std::size_t i = 0; i < positions.size(); ++i) {
      positions[i] = wild.origin[i % 3] + double{wild.positions_single[i]};
      velocities[i] = speed(random);
    }
    ASSERT_EQ(wobble_world_set_motion(world, number, wild.vertex_count, positions.data(), velocities.data()),
              WOBBLE_WORLD_OK);
  }
  auto report = Make<wobble_world_report>();
  ASSERT_EQ(wobble_world_step(world, 60, &report), WOBBLE_WORLD_OK);
  EXPECT_GT(report.torn, 0U);
  EXPECT_GT(report.reset, 0U);
  for (const std::uint32_t number : {2U, 3U}) {
    const wobble_world_body after = Body(number - 2);
    EXPECT_EQ(after.body, number);
    EXPECT_EQ(after.positions_single, before[number - 1].positions_single);
    EXPECT_EQ(after.velocities_single, before[number - 1].velocities_single);
    EXPECT_EQ(after.vertex_count, before[number - 1].vertex_count);
  }
}

TEST_F(WorldInterface, RecordingsArePlayedAndWoundToTheBit) {
  const std::string file = test::FindSource("tests/determinism/recordings/sumo.wobrec");
  std::array<char, 200> message{};
  ASSERT_EQ(wobble_world_open_recording(file.c_str(), 1, &world, message.data(), message.size()), WOBBLE_WORLD_OK)
      << message.data();
  auto info = Make<wobble_world_info>();
  ASSERT_EQ(wobble_world_read_info(world, &info), WOBBLE_WORLD_OK);
  EXPECT_EQ(info.is_recording, 1);
  EXPECT_STREQ(info.scene, "sumo");
  const std::uint32_t length = info.last_tick - info.first_tick;
  ASSERT_GT(length, 60U);
  ASSERT_EQ(wobble_world_step(world, 50, nullptr), WOBBLE_WORLD_OK);
  const std::uint64_t then = Hash();
  auto report = Make<wobble_world_report>();
  EXPECT_EQ(wobble_world_step(world, length, &report), WOBBLE_WORLD_AT_END);
  EXPECT_EQ(report.ticks, length - 50);
  ASSERT_EQ(wobble_world_seek(world, info.first_tick + 50), WOBBLE_WORLD_OK);
  EXPECT_EQ(Hash(), then);
  EXPECT_EQ(wobble_world_seek(world, info.last_tick + 1), WOBBLE_WORLD_BAD_VALUE);
  const double up[3] = {0, 0, 1};
  EXPECT_EQ(wobble_world_push(world, Body(0).body, 1, nullptr, up), WOBBLE_WORLD_RECORDED);
  EXPECT_EQ(Hash(), then);
}

TEST_F(WorldInterface, ScenesWithMistakesAreNotMadeAndEachIsNamed) {
  std::array<char, 400> message{};
  wobble_world_options options = MakeOptions(nullptr);
  options.text = "[[blueprint]]\nname = \"ball\"\nmass = -1\ncolour = 3\n";
  EXPECT_EQ(wobble_world_load(&options, &world, message.data(), message.size()), WOBBLE_WORLD_BAD_SCENE);
  EXPECT_EQ(world, nullptr);
  EXPECT_THAT(message.data(), testing::AllOf(testing::HasSubstr("scene:3: mass = -1"), testing::HasSubstr("colour")));
  std::array<char, 8> little{};
  EXPECT_EQ(wobble_world_load(&options, &world, little.data(), little.size()), WOBBLE_WORLD_BAD_SCENE);
  EXPECT_EQ(std::string(little.data()).size(), 7U);
  options = MakeOptions("nowhere");
  EXPECT_EQ(wobble_world_load(&options, &world, nullptr, 0), WOBBLE_WORLD_BAD_SCENE);
  EXPECT_EQ(wobble_world_open_recording("/nowhere.wobrec", 1, &world, message.data(), message.size()),
            WOBBLE_WORLD_BAD_FILE);
  EXPECT_THAT(message.data(), testing::StartsWith("/nowhere.wobrec "));
}

// An older program's smaller struct is not known yet; a newer one's larger struct keeps what the library does not know.
TEST_F(WorldInterface, TouchesNothingBeyondTheStructsSize) {
  Load(MakeOptions("pair"));
  struct {
    wobble_world_info info{};
    std::uint64_t newer = 42;
  } later;
  later.info.struct_size = sizeof later;
  EXPECT_EQ(wobble_world_read_info(world, &later.info), WOBBLE_WORLD_OK);
  EXPECT_EQ(later.newer, 42U);
  EXPECT_EQ(later.info.struct_size, sizeof later);
  later.info.struct_size = sizeof later.info - 1;
  EXPECT_EQ(wobble_world_read_info(world, &later.info), WOBBLE_WORLD_BAD_SIZE);
}

// Any call with any numbers: a code, no crash, and the hash stays.
TEST_F(WorldInterface, WrongCallsGetACodeAndChangeNothing) {
  Load(MakeOptions("pair"));
  ASSERT_EQ(wobble_world_step(world, 5, nullptr), WOBBLE_WORLD_OK);
  const std::uint64_t before = Hash();
  auto options = MakeOptions("pair");
  wobble_world* none = nullptr;
  const auto refuse = [&](wobble_world_result expected) {
    EXPECT_EQ(wobble_world_load(&options, &none, nullptr, 0), expected);
    EXPECT_EQ(none, nullptr);
    options = MakeOptions("pair");
  };
  options.flags = 3;
  refuse(WOBBLE_WORLD_BAD_FLAGS);
  options.flags = 8;
  refuse(WOBBLE_WORLD_BAD_FLAGS);
  options.text = "";
  refuse(WOBBLE_WORLD_NULL);
  options.struct_size = 0;
  refuse(WOBBLE_WORLD_BAD_SIZE);
  for (const double rate : {kNaN, -1.0, 0.5, 1e4}) {
    options.tick_rate = rate;
    refuse(WOBBLE_WORLD_BAD_VALUE);
  }
  options.threads = 65;
  options.substeps = 70000;
  std::array<char, 200> message{};
  EXPECT_EQ(wobble_world_load(&options, &none, message.data(), message.size()), WOBBLE_WORLD_BAD_VALUE);
  EXPECT_STREQ(message.data(), "threads = 65: must be 1 to 64\nsubsteps = 70000: must be 1 to 65536");
  options = MakeOptions("pair");
  EXPECT_EQ(wobble_world_load(&options, nullptr, nullptr, 0), WOBBLE_WORLD_NULL);
  EXPECT_EQ(wobble_world_load(nullptr, &none, nullptr, 0), WOBBLE_WORLD_NULL);
  wobble_world_free(nullptr);

  std::mt19937_64 random(1);
  const std::vector<double> numbers{0, 1, -1, 1e300, -1e300, kNaN, std::numeric_limits<double>::infinity()};
  const auto pick = [&] { return numbers[random() % numbers.size()]; };
  for (int i = 0; i < 2000; ++i) {
    const std::uint32_t body = random() % 2 == 0 ? 0 : 100 + static_cast<std::uint32_t>(random() % 5);
    const std::array<double, 3> vector{pick(), pick(), pick()};
    const std::uint16_t vertex = static_cast<std::uint16_t>(random());
    EXPECT_LT(wobble_world_push(world, body, 1, &vertex, vector.data()), 0);
    EXPECT_LT(wobble_world_push(world, 1, 1 + static_cast<std::uint32_t>(random() % 3), &vertex, nullptr), 0);
    EXPECT_LT(wobble_world_set_control(world, body, vector.data(), static_cast<std::uint32_t>(random())), 0);
    EXPECT_LT(
        wobble_world_set_motion(world, body, static_cast<std::uint32_t>(random() % 9), vector.data(), vector.data()),
        0);
    EXPECT_LT(wobble_world_remove_body(world, body), 0);
    auto energy = Make<wobble_world_energy>();
    EXPECT_TRUE(body == 0 || wobble_world_read_energy(world, body, &energy) < 0);
    std::uint32_t added = 7;
    EXPECT_LT(wobble_world_add_body(world, "no such kind", vector.data(), nullptr, &added), 0);
    EXPECT_EQ(added, 7U);
  }
  const double wrong[3] = {0, kNaN, 0};
  EXPECT_EQ(wobble_world_set_gravity(world, wrong), WOBBLE_WORLD_BAD_VALUE);
  EXPECT_EQ(wobble_world_seek(world, 1), WOBBLE_WORLD_BAD_VALUE);
  const std::uint16_t beyond = 60000;
  const double push[3] = {};
  EXPECT_EQ(wobble_world_push(world, Body(0).body, 1, &beyond, push), WOBBLE_WORLD_BAD_VALUE);
  EXPECT_EQ(wobble_world_read_info(nullptr, nullptr), WOBBLE_WORLD_NULL);
  EXPECT_EQ(wobble_world_read_info(world, nullptr), WOBBLE_WORLD_NULL);
  EXPECT_EQ(Hash(), before);
  for (int result = -20; result < 5; ++result) EXPECT_NE(std::string(wobble_world_describe(result)), "");
}

}  // namespace
}  // namespace wobble
