// Plays every shipped scene with a scripted player and compares the world's hash after each second with golden.txt.
//
//   golden_test SCENE_FOLDER GOLDEN_FILE [THREADS [SECONDS [LANES [SCENE...]]]]   compares; exit 1 when any differs
//   golden_test SCENE_FOLDER --write                                              prints a new table
//
// Without SCENE it plays all scenes of the folder.
//
// A golden hash changes only when the physics is meant to change; then the new table is part of that commit. The same
// program is built by gcc and by clang: both must agree with the one table.
#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iostream>
#include <sstream>
#include <string>
#include <vector>

#include "server/scenes/loader.h"

namespace {

using namespace wobble;

constexpr int kSeconds = 3;
constexpr int kTickHz = 60;
constexpr std::uint64_t kSeed = 1;

physics::Control MakeScriptedControl(int tick) {
  physics::Control control;
  control.moveX = tick % 120 < 60 ? 0.6 : -0.6;
  control.moveY = tick % 200 < 100 ? 0.8 : -0.8;
  control.jump = tick % 45 < 5;
  control.puff = tick % 90 < 30;
  control.stiffen = tick % 150 < 50;
  return control;
}

// One line per second: scene, second, hash.
std::string PlayScene(const scenes::Scene& scene, int threads, int seconds, int lanes) {
  physics::WorldSettings settings = scenes::MakeWorldSettings(scene, 1.0 / kTickHz, threads);
  settings.widestPack = lanes;
  physics::World world(settings);
  [[maybe_unused]] const auto placed = scenes::FillWorld(scene, kSeed, world);
  const physics::BodyId player =
      world.AddBody(static_cast<std::uint8_t>(scene.player.blueprint), scenes::FindSpawn(scene.player, 1));
  std::string lines;
  for (int tick = 0; tick < seconds * kTickHz; ++tick) {
    world.SetControl(player, MakeScriptedControl(tick), scene.player.limits);
    world.Step();
    if (world.Tick() % kTickHz != 0) continue;
    char line[128];
    std::snprintf(line, sizeof line, "%s %u %016" PRIx64 "\n", scene.name.c_str(), world.Tick() / kTickHz,
                  world.Hash());
    lines += line;
  }
  return lines;
}

// The lines of the table for the first `seconds` seconds of `played` scenes.
std::string ReadGolden(const char* path, int seconds, const std::vector<std::string>& played) {
  std::ifstream file(path);
  std::string lines;
  for (std::string line; std::getline(file, line);) {
    std::istringstream words(line);
    std::string scene;
    int second = 0;
    words >> scene >> second;
    const bool isPlayed = std::find(played.begin(), played.end(), scene) != played.end();
    if (second <= seconds && isPlayed) lines += line + "\n";
  }
  return lines;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr,
                 "usage: golden_test SCENE_FOLDER GOLDEN_FILE|--write [THREADS [SECONDS [LANES [SCENE...]]]]\n");
    return 2;
  }
  const int threads = argc > 3 ? std::atoi(argv[3]) : 1;
  const int seconds = argc > 4 ? std::atoi(argv[4]) : kSeconds;
  const int lanes = argc > 5 ? std::atoi(argv[5]) : physics::WorldSettings().widestPack;
  std::vector<std::string> played(argv + std::min(argc, 6), argv + argc);
  if (played.empty()) {
    for (const scenes::SceneSummary& summary : scenes::ListScenes(argv[1])) played.push_back(summary.name);
  }
  std::string table;
  for (const std::string& name : played) {
    const scenes::LoadResult loaded = scenes::LoadScene(name, argv[1]);
    if (!loaded.errors.empty()) {
      std::fprintf(stderr, "%s\n", loaded.errors.front().c_str());
      return 2;
    }
    table += PlayScene(loaded.scene, threads, seconds, lanes);
  }
  if (std::strcmp(argv[2], "--write") == 0) {
    std::cout << table;
    return 0;
  }

  const std::string golden = ReadGolden(argv[2], seconds, played);
  if (golden == table && !table.empty()) return 0;
  std::cout << "expected (" << argv[2] << "):\n" << golden << "\nplayed:\n" << table;
  return 1;
}
