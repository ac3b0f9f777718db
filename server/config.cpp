// All options and all limits of the protocol are checked before anything starts, so that one run reports every mistake.
#include "server/config.h"

#include <algorithm>

#include "protocol/limits.h"

namespace wobble::server {
namespace {

void Check(std::vector<std::string>& errors, const char* option, double value, Range range) {
  if (value >= range.low && value <= range.high) return;
  const auto print = [](double number) {
    std::string text = std::to_string(number);
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
    return text;
  };
  errors.push_back(std::string(option) + " " + print(value) + ": must be " + print(range.low) + " to " +
                   print(range.high));
}

void CheckMatch(std::vector<std::string>& errors, const Config& config, std::span<const scenes::Scene> scenes) {
  Check(errors, "--rounds", config.rounds, kRoundsRange);
  const auto hasGame = [](const scenes::Scene& scene) { return scene.game.kind != scenes::GameRules::Kind::kNone; };
  if (config.rounds > 0 && std::ranges::none_of(scenes, hasGame)) {
    const std::string which =
        scenes.size() == 1 ? "scene " + scenes.front().name + " has no game" : "no scene of the rotation has a game";
    errors.push_back("--rounds " + std::to_string(config.rounds) + ": " + which);
  }
  if (config.afterMatch == AfterMatch::kRestart && config.rounds == 0) {
    errors.emplace_back("--after-match restart: --rounds must say how many rounds make a match");
  }
}

void CheckScene(std::vector<std::string>& errors, const Config& config, const scenes::Scene& scene) {
  for (const scenes::BlueprintDefinition& blueprint : scene.blueprints) {
    const std::size_t vertices = scenes::CountVertices(blueprint);
    if (vertices > protocol::kMaxBodyVertices) {
      errors.push_back("scene " + scene.name + ": blueprint " + scenes::NameOf(blueprint) + " has " +
                       std::to_string(vertices) + " vertices; a hosted body may have at most " +
                       std::to_string(protocol::kMaxBodyVertices));
    }
  }
  const std::size_t bodies = scenes::CountBodies(scene) + static_cast<std::size_t>(config.maxClients);
  if (bodies > protocol::kMaxBodies) {
    errors.push_back("scene " + scene.name + ": " + std::to_string(bodies) + " bodies with all players in; at most " +
                     std::to_string(protocol::kMaxBodies));
  }
  const auto isGround = [](const physics::Obstacle& obstacle) {
    return obstacle.kind == physics::Obstacle::Kind::kHeightField;
  };
  const auto grounds =
      static_cast<std::size_t>(std::count_if(scene.obstacles.begin(), scene.obstacles.end(), isGround));
  if (grounds > protocol::kMaxHeightFields) {
    errors.push_back("scene " + scene.name + ": " + std::to_string(grounds) + " height fields; at most " +
                     std::to_string(protocol::kMaxHeightFields));
  }
  if (scene.obstacles.size() - grounds > protocol::kMaxObstacles) {
    errors.push_back("scene " + scene.name + ": " + std::to_string(scene.obstacles.size() - grounds) +
                     " obstacles besides height fields; at most " + std::to_string(protocol::kMaxObstacles));
  }
  if (scene.blueprints.size() > protocol::kMaxBlueprints) {
    errors.push_back("scene " + scene.name + ": " + std::to_string(scene.blueprints.size()) + " blueprints; at most " +
                     std::to_string(protocol::kMaxBlueprints));
  }
}

}  // namespace

std::vector<std::string> Validate(const Config& config, std::span<const scenes::Scene> scenes) {
  std::vector<std::string> errors;
  Check(errors, "--port", config.port, kPortRange);
  Check(errors, "--tick-hz", config.tickHz, kTickHzRange);
  Check(errors, "--snapshot-hz", config.snapshotHz, {kSnapshotHzRange.low, static_cast<double>(config.tickHz)});
  Check(errors, "--max-clients", config.maxClients, kMaxClientsRange);
  Check(errors, "--max-per-address", config.maxPerAddress, kMaxPerAddressRange);
  Check(errors, "--threads", config.threads, kThreadsRange);
  Check(errors, "--client-kbit", config.clientKbit, kClientKbitRange);
  Check(errors, "--view-distance", config.viewDistance, kViewDistanceRange);
  CheckMatch(errors, config, scenes);
  Check(errors, "--pause-after", config.pauseAfter, kPauseAfterRange);
  for (const scenes::Scene& scene : scenes) CheckScene(errors, config, scene);
  return errors;
}

}  // namespace wobble::server
