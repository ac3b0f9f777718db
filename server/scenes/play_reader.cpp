#include "server/scenes/play_reader.h"

#include <map>

#include "server/scenes/blueprint_reader.h"

namespace wobble::scenes {
namespace {

void ReadHands(TableReader& reader, HandRules& hands) {
  reader.Read("grab", hands.grab);
  reader.Read("cut", hands.cut);
  reader.Read("push", hands.push);
  reader.Read("reach", 0, 1000, " m", hands.reach);
  reader.Read("radius", 0.01, 10, " m", hands.radius);
  reader.Read("strength", 0, 1e5, " N", hands.strength);
  reader.Read("impulse", 0, 1e4, " N·s", hands.impulse);
}

void ReadTuning(TableReader& reader, TuningRules& tuning) {
  static const std::map<std::string, Who> kWho{
      {"nobody", Who::kNobody}, {"host", Who::kHost}, {"everyone", Who::kEveryone}};
  reader.Read("gravity", kWho, tuning.gravity);
  reader.Read("stiffness", kWho, tuning.stiffness);
  reader.Read("time", kWho, tuning.time);
}

bool HasOneBody(const Scene& scene, std::size_t blueprint) {
  int bodies = 0;
  for (const BodyGroup& group : scene.groups) {
    if (group.blueprint == blueprint) bodies += group.count[0] * group.count[1] * group.count[2];
  }
  return bodies == 1;
}

bool IsGraphOfOneBody(const Scene& scene, std::size_t blueprint) {
  if (blueprint >= scene.blueprints.size()) return true;  // already refused
  return HasOneBody(scene, blueprint) && std::holds_alternative<physics::GraphDefinition>(scene.blueprints[blueprint]);
}

void ReadWorkshop(TableReader& reader, Scene& scene) {
  WorkshopRules& workshop = scene.workshop;
  workshop.isOpen = true;
  ReadBlueprintName(reader, scene, workshop.blueprint);
  reader.Read("particles_each", 1, static_cast<int>(physics::kMaxParticles), workshop.particlesEach);
  reader.Read("springs_each", 1, static_cast<int>(physics::kMaxGraphSprings), workshop.springsEach);
  reader.Read("protected", workshop.isProtected);
  if (!IsGraphOfOneBody(scene, workshop.blueprint)) {
    reader.RefuseAsWritten("blueprint", "given", "a graph of which [[bodies]] has exactly one");
  }
}

void ReadGame(TableReader& reader, Scene& scene) {
  using Kind = GameRules::Kind;
  static const std::map<std::string, Kind> kKinds{
      {"sumo", Kind::kSumo}, {"goals", Kind::kGoals}, {"crown", Kind::kCrown}};
  GameRules& game = scene.game;
  reader.Require("kind");
  if (!reader.Read("kind", kKinds, game.kind)) return reader.PassOver();
  reader.Read("round", 10, 3600, " s", game.roundSeconds);
  reader.Read("points", 1, 1000, game.pointsToWin);
  reader.Read("rounds", 0, 1000, game.rounds);
  reader.Read("lobby", 0, 600, " s", game.lobbySeconds);
  if (game.HasObject()) {
    ReadBlueprintName(reader, scene, game.object);
    if (game.object < scene.blueprints.size() && !HasOneBody(scene, game.object)) {
      reader.RefuseAsWritten("blueprint", "given", "one of which [[bodies]] has exactly one");
    }
  }
  if (game.kind != Kind::kGoals) return;
  reader.Read("goal_line", 1, 1000, " m", game.goalLine);
  reader.Read("goal_half_width", 0.5, 1000, " m", game.goalHalfWidth);
  reader.Read("goal_height", 0.5, 1000, " m", game.goalHeight);
  reader.Read("kick_off", 0, 1000, " m", game.kickOff);
}

}  // namespace

void ReadPlayRules(TableReader& reader, Scene& scene) {
  reader.ReadTables("hands", [&](TableReader& table) { ReadHands(table, scene.hands); });
  reader.ReadTables("tuning", [&](TableReader& table) { ReadTuning(table, scene.tuning); });
  reader.ReadTables("workshop", [&](TableReader& table) { ReadWorkshop(table, scene); });
  reader.ReadTables("game", [&](TableReader& table) { ReadGame(table, scene); });
}

}  // namespace wobble::scenes
