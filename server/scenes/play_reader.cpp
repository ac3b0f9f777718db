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

bool IsGraphOfOneBody(const Scene& scene, std::size_t blueprint) {
  if (blueprint >= scene.blueprints.size()) return true;  // already refused
  int bodies = 0;
  for (const BodyGroup& group : scene.groups) {
    if (group.blueprint == blueprint) bodies += group.count[0] * group.count[1] * group.count[2];
  }
  return bodies == 1 && std::holds_alternative<physics::GraphDefinition>(scene.blueprints[blueprint]);
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

void ReadGame(TableReader& reader, GameRules& game) {
  reader.Require("kind");
  reader.Read("kind", std::map<std::string, GameRules::Kind>{{"sumo", GameRules::Kind::kSumo}}, game.kind);
  reader.Read("round", 10, 3600, " s", game.roundSeconds);
  reader.Read("points", 1, 1000, game.pointsToWin);
}

}  // namespace

void ReadPlayRules(TableReader& reader, Scene& scene) {
  reader.ReadTables("hands", [&](TableReader& table) { ReadHands(table, scene.hands); });
  reader.ReadTables("tuning", [&](TableReader& table) { ReadTuning(table, scene.tuning); });
  reader.ReadTables("workshop", [&](TableReader& table) { ReadWorkshop(table, scene); });
  reader.ReadTables("game", [&](TableReader& table) { ReadGame(table, scene.game); });
}

}  // namespace wobble::scenes
