// Plays a recording of every shipped scene again and compares every tick with it.
//
//   golden_recordings FOLDER THREADS LANES   exit 1 when any differs, or a scene has no recording
//   golden_recordings FOLDER --write         records them anew
//
// They are renewed together with golden.txt, when the physics is meant to change, and when the format does. The same
// files are played by what gcc and what clang have built.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

#include "server/recording/verify.h"
#include "tests/support/match.h"

namespace {

using namespace wobble;

constexpr std::uint32_t kTicks = 150;

std::filesystem::path FindFile(const std::filesystem::path& folder, const std::string& scene) {
  return folder / (scene + ".wobrec");
}

void Write(const std::filesystem::path& folder, const std::string& scene) {
  const std::filesystem::path scratch = folder / ("new-" + scene);
  std::filesystem::create_directories(scratch);
  recording::RecordMatch(scene, kTicks, {.folder = scratch, .readUnixTime = [] { return std::uint64_t{0}; }});
  for (const auto& entry : std::filesystem::directory_iterator(scratch)) {
    std::filesystem::rename(entry.path(), FindFile(folder, scene));
  }
  std::filesystem::remove_all(scratch);
}

bool Compare(const std::filesystem::path& file, const recording::GroundSettings& settings) {
  const recording::Proof proof = recording::Verify(file, settings, [](double, double) { return true; });
  if (proof.verdict == recording::Verdict::kIdentical) return true;
  std::printf("%s: %s\n", file.c_str(), proof.words.c_str());
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) {
    std::fprintf(stderr, "usage: golden_recordings FOLDER THREADS LANES | FOLDER --write\n");
    return 2;
  }
  const bool writes = std::strcmp(argv[2], "--write") == 0;
  recording::GroundSettings settings;
  if (!writes) settings.threads = std::atoi(argv[2]);
  if (argc > 3) settings.widestPack = std::atoi(argv[3]);
  bool isSame = true;
  for (const scenes::SceneSummary& scene : scenes::ListScenes(WOBBLE_SOURCE_DIR "/server/scenes")) {
    if (writes) {
      Write(argv[1], scene.name);
    } else {
      isSame = Compare(FindFile(argv[1], scene.name), settings) && isSame;
    }
  }
  return isSame ? 0 : 1;
}
