// Loads scenes from TOML files. All mistakes of a file are reported together, each with its line, value and range.
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

// Reads a scene from TOML text. label: a path, which names the source in errors; files that the scene names are looked
// for in its folder. Any text is safe: one of more than kMaxSceneBytes (text_file.h), or nested too deep (nesting.h),
// is refused unread.
[[nodiscard]] LoadResult ParseScene(const std::string& text, const std::string& label);

// Loads a scene from a path, if the text has a slash or ends in .toml, otherwise by its name from `folder`.
[[nodiscard]] LoadResult LoadScene(const std::string& nameOrPath, const std::filesystem::path& folder);

struct SceneSummary {
  std::string name;
  std::string description;
};
// The folder of the shipped scenes: `scenes` beside the running program, as in a build folder, or
// ../share/wobble/scenes, as installed. The latter is returned, though it does not exist, when there is neither.
[[nodiscard]] std::filesystem::path FindShippedScenes();

// The scenes in the folder, sorted by name. A scene with mistakes is listed with the first of them.
[[nodiscard]] std::vector<SceneSummary> ListScenes(const std::filesystem::path& folder);

}  // namespace wobble::scenes
