// Short matches, played and recorded.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "server/recording/recorder.h"
#include "tests/support/game.h"

namespace wobble::recording {

inline scenes::SceneSource LoadSource(const std::string& name) {
  return scenes::LoadScene(name, WOBBLE_SOURCE_DIR "/server/scenes").source;
}

// A folder of its own that goes with the test.
class Folder {
 public:
  Folder()
      : m_path(std::filesystem::temp_directory_path() /
               ("wobrec-" + std::to_string(getpid()) + "-" +
                testing::UnitTest::GetInstance()->current_test_info()->name())) {
    std::filesystem::remove_all(m_path);
    std::filesystem::create_directories(m_path);
  }
  ~Folder() { std::filesystem::remove_all(m_path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  [[nodiscard]] const std::filesystem::path& Path() const { return m_path; }
  [[nodiscard]] std::vector<std::filesystem::path> List() const {
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::directory_iterator(m_path)) files.push_back(entry.path());
    std::sort(files.begin(), files.end());
    return files;
  }

 private:
  std::filesystem::path m_path;
};

inline Head MakeHead(const std::string& scene) {
  return {.version = "test", .scene = LoadSource(scene), .tickHz = 60, .seed = 1, .beginsFresh = true};
}

// What two players do in a tick: run, hold, shove and cut.
inline void ActInMatch(server::Playground& ground) {
  const std::uint32_t tick = ground.World().Tick();
  if (tick == 10) ground.Take(server::JoinEntry{1, false, "Ada"});
  if (tick == 40) ground.Take(server::JoinEntry{2, false, "Bo"});
  if (tick < 50 || ground.World().Bodies().empty()) return;
  const physics::BodyId body = ground.World().Bodies()[tick / 60 % ground.World().Bodies().size()].id;
  const physics::Vector3d at = ground.World().FindCentre(ground.World().ReadBody(body));
  for (const server::ClientId client : {1U, 2U}) {
    server::MoveEntry move{.client = client, .control = {}, .hand = {}};
    move.control.moveX = (tick / 20 + client) % 3 == 0 ? 0.5 : -0.25;
    move.control.jump = tick % 40 == client;
    if (tick / 50 % 2 == 1) move.hand = server::HandCommand{body, 1, static_cast<std::uint16_t>(tick / 50), at};
    if (!ground.IsInForce(move)) ground.Take(move);
  }
  if (tick % 45 == 0) ground.Take(server::ActEntry{.client = 1, .command = server::ShoveCommand{body, 2, {0, 1, 1}}});
  if (tick % 45 == 30) {
    const server::CutCommand cut{body, at + physics::Vector3d(0, -1.5, 0), at + physics::Vector3d(-1, 0.5, 0),
                                 at + physics::Vector3d(1, 0.5, 0.2)};
    ground.Take(server::ActEntry{.client = 2, .command = cut});
  }
}

// Plays a match of so many ticks and records it.
inline RecorderCounts RecordMatch(const std::string& scene, std::uint32_t ticks, const RecorderSettings& settings,
                                  std::uint32_t newFileAt = 0) {
  const Head head = MakeHead(scene);
  server::Playground ground(scenes::ParseScene(head.scene).scene, {});
  Recorder recorder(settings, head, ground);
  ground.SetListener([&](const server::Entry& entry) { recorder.Note(entry, ground.World().Tick()); });
  while (ground.World().Tick() < ticks) {
    if (newFileAt > 0 && ground.World().Tick() == newFileAt) recorder.BeginFile();
    ActInMatch(ground);
    ground.Step();
    recorder.FollowTick(ground);
  }
  recorder.Close();
  return recorder.Counts();
}

inline RecorderSettings MakeSettings(const Folder& folder) {
  return {.folder = folder.Path(), .readUnixTime = [] { return std::uint64_t{1'700'000'000}; }};
}

inline Bytes ReadFile(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

inline void WriteFile(const std::filesystem::path& path, std::span<const std::uint8_t> bytes) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace wobble::recording
