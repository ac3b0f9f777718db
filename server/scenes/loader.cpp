// Reads a scene table by table. Blueprints, obstacles, drives and play rules have readers of their own.
#include "server/scenes/loader.h"

#include <toml++/toml.h>
#include <algorithm>
#include <map>

#include "server/physics/methods/stability.h"
#include "server/scenes/blueprint_reader.h"
#include "server/scenes/drive_reader.h"
#include "server/scenes/nesting.h"
#include "server/scenes/obstacle_reader.h"
#include "server/scenes/play_reader.h"
#include "server/scenes/table_reader.h"
#include "server/scenes/text_file.h"

namespace wobble::scenes {
namespace {

using physics::Vector3d;

constexpr std::size_t kMaxSceneBodies = 20000;
constexpr double kMinErrorTarget = 1e-6;  // m/s: a smaller error is below the resolution of single precision
constexpr double kMaxErrorTarget = 1;
constexpr double kMinStretch = 0.2;
constexpr double kMaxStretch = 3;

void ReadBodyGroup(TableReader& reader, Scene& scene) {
  BodyGroup group;
  ReadBlueprintName(reader, scene, group.blueprint);
  reader.Read("position", -kPlacesWithin, kPlacesWithin, " m", group.position);
  reader.Read("count", 1, 1000, group.count);
  reader.Read("spacing", -100, 100, " m", group.spacing);
  reader.Read("jitter", 0, 10, " m", group.jitter);
  reader.Read("velocity", -50, 50, " m/s", group.velocity);
  reader.Read("stretch", kMinStretch, kMaxStretch, "", group.stretch);
  scene.groups.push_back(group);
}

void ReadPlayer(TableReader& reader, Scene& scene) {
  PlayerRules& player = scene.player;
  ReadBlueprintName(reader, scene, player.blueprint);
  reader.Read("spawn", -kPlacesWithin, kPlacesWithin, " m", player.spawn);
  reader.Read("spawn_radius", 0, 1000, " m", player.spawnRadius);
  reader.Read("acceleration", 0, 200, " m/s²", player.limits.acceleration);
  reader.Read("speed", 0, 50, " m/s", player.limits.speed);
  reader.Read("jump_speed", 0, 50, " m/s", player.limits.jumpSpeed);
  reader.Read("puff", 1, 3, "", player.limits.puffFactor);
  reader.Read("stiffen", 1, 4, "", player.limits.stiffenFactor);
}

void ReadScene(TableReader& reader, const MeshReader& readMesh, Scene& scene) {
  using physics::Precision;
  reader.Read("description", 256, scene.description);
  reader.Read("gravity", -100, 100, " m/s²", scene.gravity);
  reader.Read("precision",
              std::map<std::string, Precision>{{"float", Precision::kSingle}, {"double", Precision::kDouble}},
              scene.precision);
  reader.Read("error_target", kMinErrorTarget, kMaxErrorTarget, " m/s", scene.errorTarget);
  reader.Read("max_substeps", 1, physics::kMaxSubsteps, scene.maxSubsteps);
  reader.Read("wind", -50, 50, " m/s", scene.wind);
  physics::Integrator integrator = physics::Integrator::kRungeKutta4;
  ReadIntegrator(reader, integrator);
  reader.Read("kill_height", -kPlacesWithin, kPlacesWithin, " m", scene.killHeight);
  reader.Require("blueprint");
  reader.Require("player");
  reader.ReadTables("obstacle", [&](TableReader& table) { ReadObstacle(table, scene); });
  reader.ReadTables("blueprint", [&](TableReader& table) { ReadBlueprint(table, readMesh, integrator, scene); });
  reader.ReadTables("bodies", [&](TableReader& table) { ReadBodyGroup(table, scene); });
  reader.ReadTables("drive", [&](TableReader& table) { ReadDrive(table, scene); });
  reader.ReadTables("player", [&](TableReader& table) { ReadPlayer(table, scene); });
  ReadPlayRules(reader, scene);
  if (const std::size_t bodies = CountBodies(scene); bodies > kMaxSceneBodies) {
    reader.Refuse("bodies", std::to_string(bodies), "at most " + std::to_string(kMaxSceneBodies) + " in all");
  }
  reader.ReportUnknown();
}

LoadResult ParseText(const std::string& text, const std::string& label, const MeshReader& readMesh) {
  LoadResult result;
  result.scene.name = std::filesystem::path(label).stem().string();
  const std::string fileName = std::filesystem::path(label).filename().string();
  if (text.size() > kMaxSceneBytes) {
    result.errors.push_back(fileName + ": " + std::to_string(text.size()) + " bytes: must be at most " +
                            std::to_string(kMaxSceneBytes));
    return result;
  }
  ErrorList errors(fileName);
  if (const auto fault = FindDeepNesting(text)) {
    const auto line = static_cast<toml::source_index>(fault->line);
    errors.Add({{line, 1}, {line, 1}, nullptr}, fault->what);
    result.errors = errors.Take();
    return result;
  }
  try {
    const toml::table table = toml::parse(text, label);
    TableReader reader(table, errors);
    ReadScene(reader, readMesh, result.scene);
  } catch (const toml::parse_error& error) {
    errors.Add(error.source(), std::string(error.description()));
  }
  result.errors = errors.Take();
  return result;
}

}  // namespace

LoadResult ParseScene(const std::string& text, const std::string& label) {
  std::map<std::string, std::string> meshes;
  const std::filesystem::path folder = std::filesystem::path(label).parent_path();
  LoadResult result =
      ParseText(text, label, [&](const std::string& file) { return LoadObj(folder / file, meshes[file]); });
  result.source = {.name = result.scene.name, .text = text, .meshes = std::move(meshes)};
  return result;
}

LoadResult ParseScene(const SceneSource& source) {
  LoadResult result = ParseText(source.text, source.name + ".toml", [&](const std::string& file) {
    const auto found = source.meshes.find(file);
    if (found != source.meshes.end()) return ParseObj(found->second);
    return ObjMesh{.vertices = {}, .faces = {}, .errors = {"is not among the scene's files"}};
  });
  result.source = source;
  return result;
}

LoadResult LoadScene(const std::string& nameOrPath, const std::filesystem::path& folder) {
  const bool isPath = nameOrPath.find('/') != std::string::npos || nameOrPath.ends_with(".toml");
  const std::filesystem::path path = isPath ? std::filesystem::path(nameOrPath) : folder / (nameOrPath + ".toml");
  std::string text;
  const std::string fault = ReadTextFile(path, kMaxSceneBytes, text);
  if (fault.empty()) return ParseScene(text, path.string());
  LoadResult result;
  if (isPath) {
    result.errors.push_back("scene file '" + nameOrPath + "' " + fault);
    return result;
  }
  std::string names;
  for (const SceneSummary& scene : ListScenes(folder)) names += (names.empty() ? "" : ", ") + scene.name;
  result.errors.push_back("scene '" + nameOrPath + "' is not known; one of: " + names + ", or a path to a .toml file");
  return result;
}

std::filesystem::path FindShippedScenes() {
  std::error_code error;
  const std::filesystem::path programs = std::filesystem::read_symlink("/proc/self/exe", error).parent_path();
  if (std::filesystem::is_directory(programs / "scenes", error)) return programs / "scenes";
  return programs.parent_path() / "share" / "wobble" / "scenes";
}

std::vector<SceneSummary> ListScenes(const std::filesystem::path& folder) {
  std::vector<SceneSummary> scenes;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.path().extension() != ".toml") continue;
    const LoadResult loaded = LoadScene(entry.path().string(), folder);
    scenes.push_back({entry.path().stem().string(),
                      loaded.errors.empty() ? loaded.scene.description : "(has errors) " + loaded.errors.front()});
  }
  std::sort(scenes.begin(), scenes.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return scenes;
}

}  // namespace wobble::scenes
