// Worlds of scenes and of recordings.
#include <dlfcn.h>

#include <filesystem>
#include <system_error>
#include <utility>

#include "server/library/handle.h"
#include "server/scenes/loader.h"

namespace wobble::library {
namespace {

namespace fs = std::filesystem;

// share/wobble/scenes of the prefix that this library is installed in, or `scenes` beside it, as in a build folder. The
// program may lie anywhere: it is often an interpreter.
fs::path FindScenes() {
  Dl_info library{};
  std::error_code error;
  if (dladdr(reinterpret_cast<const void*>(&wobble_world_version), &library) != 0 && library.dli_fname != nullptr) {
    fs::path folder = fs::weakly_canonical(library.dli_fname, error).parent_path();
    // lib/, lib/x86_64-linux-gnu/, and a package of Python's in lib/python3/dist-packages/.
    for (int up = 0; up < 5 && !folder.empty(); ++up, folder = folder.parent_path()) {
      for (const char* place : {"scenes", "bin/scenes", "share/wobble/scenes"}) {
        if (fs::exists(folder / place / "arena.toml", error)) return folder / place;
      }
    }
  }
  return scenes::FindShippedScenes();
}

std::string JoinLines(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += (text.empty() ? "" : "\n") + line;
  return text;
}

}  // namespace

wobble_world_result Load(const wobble_world_options& options, std::unique_ptr<wobble_world>& world,
                         std::string& message) {
  scenes::LoadResult loaded =
      options.text != nullptr
          ? scenes::ParseScene(options.text, "scene")
          : scenes::LoadScene(options.scene, options.folder != nullptr ? fs::path(options.folder) : FindScenes());
  if (!loaded.errors.empty()) {
    message = JoinLines(loaded.errors);
    return WOBBLE_WORLD_BAD_SCENE;
  }
  auto made = std::make_unique<wobble_world>();
  made->scene = std::move(loaded.scene);
  const double tickRate = options.tick_rate > 0 ? options.tick_rate : 60;
  physics::WorldSettings settings =
      scenes::MakeWorldSettings(made->scene, 1 / tickRate, options.threads > 0 ? static_cast<int>(options.threads) : 1);
  if ((options.flags & WOBBLE_WORLD_SINGLE) != 0) settings.precision = physics::Precision::kSingle;
  if ((options.flags & WOBBLE_WORLD_DOUBLE) != 0) settings.precision = physics::Precision::kDouble;
  if (options.error_target > 0) settings.errorTarget = options.error_target;
  if (options.substeps > 0) settings.maxSubsteps = settings.leastSubsteps = static_cast<int>(options.substeps);
  made->own = std::make_unique<physics::World>(settings);
  static_cast<void>(scenes::FillWorld(made->scene, options.seed > 0 ? options.seed : 1, *made->own));
  world = std::move(made);
  return WOBBLE_WORLD_OK;
}

wobble_world_result OpenRecording(const char* path, int threads, std::unique_ptr<wobble_world>& world,
                                  std::string& message) {
  auto made = std::make_unique<wobble_world>();
  made->film = std::make_unique<wobble_world::Film>();
  wobble_world::Film& film = *made->film;
  message = film.recording.Open(path);
  if (message.empty()) {
    film.ground = recording::MakeGround(film.recording.ReadHead(), {.threads = threads}, message);
  }
  if (message.empty()) {
    film.replay = std::make_unique<recording::Replay>(film.recording, *film.ground);
    message = film.replay->Seek(film.recording.FirstTick());
  }
  if (!message.empty()) {
    message = std::string(path) + " " + message;
    return WOBBLE_WORLD_BAD_FILE;
  }
  made->scene = film.ground->Scene();
  world = std::move(made);
  return WOBBLE_WORLD_OK;
}

}  // namespace wobble::library
