// Scenes from TOML files. Every mistake in a file is reported at once, each with its line, value and range.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "server/scenes/scene.h"

namespace wobble::scenes {

struct LoadResult {
  Scene scene;                      // meaningful only when there are no errors
  std::vector<std::string> errors;  // one line each: "arena.toml:12: mass = -1: must be 0.001 to 1000000 kg"
};

// `label` names the source in errors.
[[nodiscard]] LoadResult ParseScene(const std::string& text, const std::string& label);

// A path when it has a slash or ends in .toml, else the name of a scene in `folder`.
[[nodiscard]] LoadResult LoadScene(const std::string& nameOrPath, const std::filesystem::path& folder);

struct SceneSummary {
  std::string name;
  std::string description;
};
// The folder of the shipped scenes: `scenes` beside the running program, as in a build folder, or
// ../share/wobble/scenes, as installed. The latter is returned, though missing, when there is neither.
[[nodiscard]] std::filesystem::path FindShippedScenes();

// Scenes in the folder, by name.
[[nodiscard]] std::vector<SceneSummary> ListScenes(const std::filesystem::path& folder);

}  // namespace wobble::scenes
