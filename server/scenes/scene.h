// A scene: what a world is made of, as plain data, and the world made from it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/world.h"
#include "server/scenes/body_definition.h"
#include "server/scenes/play_rules.h"

namespace wobble::scenes {

// Bodies of one blueprint on a grid: `count` along each axis, `spacing` apart, the first at `position`, each moved by
// up to `jitter` along each axis, so that no two runs of different seeds are alike.
struct BodyGroup {
  std::size_t blueprint = 0;
  physics::Vector3d position = physics::Vector3d::Zero();  // m
  std::array<int, 3> count{1, 1, 1};
  physics::Vector3d spacing = physics::Vector3d::Zero();   // m
  double jitter = 0;                                       // m
  physics::Vector3d velocity = physics::Vector3d::Zero();  // m/s
  physics::Vector3d stretch = physics::Vector3d::Ones();   // of each about its centre when it is first put there
};

// What a blueprint of any kind is stepped with.
struct Methods {
  physics::Integrator integrator = physics::Integrator::kRungeKutta4;
  physics::ContactLaw contactLaw = physics::ContactLaw::kPenalty;
  double magneticStrength = physics::kDefaultMagneticStrength;  // N·m²
};

// A drive of every body that the scene has of a blueprint, or of all, players' too.
struct DriveRule {
  std::optional<std::size_t> blueprint;
  physics::Side side = physics::Side::kNone;  // the vertices there in the rest shape share the force; kNone: all do
  physics::Drive drive;                       // but for its body and vertices
};

// What a player gets. Players appear one after the other on a circle about `spawn`.
struct PlayerRules {
  std::size_t blueprint = 0;
  physics::Vector3d spawn{0, 0, 2};  // m
  double spawnRadius = 0;            // m
  physics::ControlLimits limits;
};

struct Scene {
  std::string name;
  std::string description;
  physics::Vector3d gravity{0, 0, -9.81};              // m/s²
  physics::Vector3d wind = physics::Vector3d::Zero();  // m/s
  physics::Precision precision = physics::Precision::kSingle;
  double errorTarget = physics::WorldSettings{}.errorTarget;  // m/s
  int maxSubsteps = physics::WorldSettings{}.maxSubsteps;
  double killHeight = -20;  // below this a body starts again, m
  std::vector<physics::Obstacle> obstacles;
  std::vector<BodyDefinition> blueprints;
  std::vector<Methods> methods;  // one a blueprint; those beyond its end have the default
  std::vector<BodyGroup> groups;
  std::vector<DriveRule> drives;
  PlayerRules player;
  HandRules hands;
  TuningRules tuning;
  WorkshopRules workshop;
  GameRules game;
};

// A body and where it starts, also after it has fallen off.
struct PlacedBody {
  physics::BodyId body = 0;
  physics::Vector3d home = physics::Vector3d::Zero();
};

// Of a world for the scene.
[[nodiscard]] physics::WorldSettings MakeWorldSettings(const Scene& scene, double tickDuration, int threads);

// Fills an empty world with the scene's obstacles, blueprints, bodies and drives. Same seed, same world.
[[nodiscard]] std::vector<PlacedBody> FillWorld(const Scene& scene, std::uint64_t seed, physics::World& world);

// The start of the index-th player, m: golden-angle steps round the circle keep any number of players apart.
[[nodiscard]] physics::Vector3d FindSpawn(const PlayerRules& player, std::uint32_t index);

// The first of the index-th, the next and so on that no body of the world lies in; above them when all are taken.
// Bodies that were put into one another would take seconds to part.
[[nodiscard]] physics::Vector3d FindFreeSpawn(const PlayerRules& player, std::uint32_t index,
                                              const physics::World& world);

// The vertices of a rest shape within 2 % of its extent of a side: all of a flat end, none beside it. Of what is round,
// balls, rings and meshes, it is a cap of 10 %. All for kNone.
[[nodiscard]] std::vector<std::uint16_t> FindSide(const BodyDefinition& definition,
                                                  const std::vector<physics::Vector3d>& rest, physics::Side side);

[[nodiscard]] std::size_t CountBodies(const Scene& scene);

}  // namespace wobble::scenes
