// Plays a recording of every shipped scene again, compares every tick with it, and at the end the whole state,
// contacts' memory included, with its hash in states.txt.
//
//   golden_recordings FOLDER THREADS LANES [SCENE...]   exit 1 when any differs, or a scene has no recording
//   golden_recordings FOLDER --write TICKS [SCENE...]   records them anew; the stored ones have 150 ticks
//
// Without SCENE it takes all shipped scenes.
// They are renewed together with golden.txt, when the physics is meant to change, and when the format does. The same
// files are played by what gcc and what clang have built.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "server/recording/verify.h"
#include "tests/support/match.h"
#include "tests/support/places.h"

namespace {

using namespace wobble;

std::filesystem::path FindFile(const std::filesystem::path& folder, const std::string& scene) {
  return folder / (scene + ".wobrec");
}

void Write(const std::filesystem::path& folder, const std::string& scene, std::uint32_t ticks) {
  const std::filesystem::path scratch = folder / ("new-" + scene);
  std::filesystem::create_directories(scratch);
  recording::RecordMatch(scene, ticks, {.folder = scratch, .readUnixTime = [] { return std::uint64_t{0}; }});
  for (const auto& entry : std::filesystem::directory_iterator(scratch)) {
    std::filesystem::rename(entry.path(), FindFile(folder, scene));
  }
  std::filesystem::remove_all(scratch);
}

// Hashes of the whole states at the recordings' ends, by scene.
using States = std::map<std::string, std::uint64_t>;

States ReadStates(const std::filesystem::path& folder) {
  States states;
  std::ifstream file(folder / "states.txt");
  for (std::string scene, hash; file >> scene >> hash;) states[scene] = std::stoull(hash, nullptr, 16);
  return states;
}

void WriteStates(const std::filesystem::path& folder, const States& states) {
  std::ofstream file(folder / "states.txt");
  for (const auto& [scene, hash] : states) file << scene << ' ' << std::hex << hash << '\n';
}

recording::Proof Prove(const std::filesystem::path& file, const recording::GroundSettings& settings) {
  return recording::Verify(file, settings, [](double, double) { return true; });
}

bool IsSame(const std::filesystem::path& file, const recording::GroundSettings& settings, std::uint64_t state) {
  recording::Proof proof = Prove(file, settings);
  if (proof.verdict == recording::Verdict::kIdentical && proof.wholeState == state) return true;
  if (proof.verdict == recording::Verdict::kIdentical)
    proof.words = "all ticks identical, and another whole state at the end";
  std::printf("%s: %s\n", file.c_str(), proof.words.c_str());
  return false;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::fprintf(stderr,
                 "usage: golden_recordings FOLDER THREADS LANES [SCENE...] | FOLDER --write TICKS [SCENE...]\n");
    return 2;
  }
  const bool writes = std::strcmp(argv[2], "--write") == 0;
  std::vector<std::string> names(argv + 4, argv + argc);
  if (names.empty()) {
    for (const auto& each : scenes::ListScenes(test::FindSource("server/scenes"))) names.push_back(each.name);
  }
  bool isSame = true;
  States states = ReadStates(argv[1]);
  for (const std::string& name : names) {
    if (writes) {
      Write(argv[1], name, static_cast<std::uint32_t>(std::atoi(argv[3])));
      states[name] = Prove(FindFile(argv[1], name), {}).wholeState;
    } else {
      const recording::GroundSettings settings{.threads = std::atoi(argv[2]), .widestPack = std::atoi(argv[3])};
      isSame = IsSame(FindFile(argv[1], name), settings, states[name]) && isSame;
    }
  }
  if (writes) WriteStates(argv[1], states);
  return isSame ? 0 : 1;
}
