// Loads scenes from TOML files. All mistakes of a file are reported together, each with its line, value and range.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "server/scenes/scene.h"

namespace wobble::scenes {

// A scene as it was read: its text, and the meshes that it names. From these it can be read again anywhere.
struct SceneSource {
  std::string name;
  std::string text;
  std::map<std::string, std::string> meshes;  // texts of OBJ files, by the names that the scene gives them
};

struct LoadResult {
  Scene scene;  // meaningful only when there are no errors
  SceneSource source;
  std::vector<std::string> errors;  // one line each: "arena.toml:12: mass = -1: must be 0.001 to 1000000 kg"
};

// Reads a scene from TOML text. label: a path, which names the source in errors; files that the scene names are looked
// for in its folder. Any text is safe: one of more than kMaxSceneBytes (text_file.h), or nested too deep (nesting.h),
// is refused unread.
[[nodiscard]] LoadResult ParseScene(const std::string& text, const std::string& label);

// Reads a scene from its source alone; no file is looked at.
[[nodiscard]] LoadResult ParseScene(const SceneSource& source);

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
