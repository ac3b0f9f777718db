// The room server/scenes reads scenes from TOML files. This file holds a scene as plain data and makes a world from it.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/world.h"
#include "server/scenes/blueprint_definition.h"
#include "server/scenes/play_rules.h"

namespace wobble::scenes {

// Bodies of one blueprint on a grid: `count` along each axis, `spacing` apart, the first at `position`. Each is
// displaced at random by up to `jitter` along each axis, so that runs of different seeds differ.
struct BodyGroup {
  std::size_t blueprint = 0;
  physics::Vector3d position = physics::Vector3d::Zero();  // m
  std::array<int, 3> count{1, 1, 1};
  physics::Vector3d spacing = physics::Vector3d::Zero();   // m
  double jitter = 0;                                       // m
  physics::Vector3d velocity = physics::Vector3d::Zero();  // m/s
  physics::Vector3d stretch = physics::Vector3d::Ones();   // about the centre, at the start only
};

// The numerical methods of a blueprint.
struct Methods {
  physics::Integrator integrator = physics::Integrator::kRungeKutta4;
  physics::ContactLaw contactLaw = physics::ContactLaw::kPenalty;
  double magneticStrength = physics::kDefaultMagneticStrength;  // N·m²
};

// A drive of every scene body of one blueprint, or of all bodies including players'.
struct DriveRule {
  std::optional<std::size_t> blueprint;       // nullopt: all bodies
  physics::Side side = physics::Side::kNone;  // the vertices on this side of the rest shape share the force; kNone: all
  physics::Drive drive;                       // body and vertices are filled in by FillWorld
};

// The body of a player and where it appears: one after the other on a circle about `spawn`.
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
  double killHeight = -20;  // a body below this height respawns, m
  std::vector<physics::Obstacle> obstacles;
  std::vector<BlueprintDefinition> blueprints;
  std::vector<Methods> methods;  // by blueprint; blueprints beyond the end have the default
  std::vector<BodyGroup> groups;
  std::vector<DriveRule> drives;
  PlayerRules player;
  HandRules hands;
  TuningRules tuning;
  WorkshopRules workshop;
  GameRules game;
};

// A body of the scene and where it starts and respawns, m.
struct PlacedBody {
  physics::BodyId body = 0;
  physics::Vector3d home = physics::Vector3d::Zero();
};

// The settings of a world for the scene. tickDuration: s. threads: 1 or more.
[[nodiscard]] physics::WorldSettings MakeWorldSettings(const Scene& scene, double tickDuration, int threads);

// Fills an empty world with the scene's obstacles, blueprints, bodies and drives. The same seed gives the same world.
// Returns the bodies by ascending id.
[[nodiscard]] std::vector<PlacedBody> FillWorld(const Scene& scene, std::uint64_t seed, physics::World& world);

// Makes the bodies that FillWorld placed with this seed what they were then, under their numbers. Players' bodies stay
// as they are.
void RefillWorld(const Scene& scene, std::uint64_t seed, std::span<const PlacedBody> placed, physics::World& world);

// The place of the index-th player on the circle, m. Steps of the golden angle keep any number of players apart.
[[nodiscard]] physics::Vector3d FindSpawn(const PlayerRules& player, std::uint32_t index);

// The first free place of the index-th player, the next and so on, m; if 16 are occupied it tries 16 more a body's
// height above, up to 16 layers. Bodies placed inside one another would take seconds to separate. O(bodies) per place.
[[nodiscard]] physics::Vector3d FindFreeSpawn(const PlayerRules& player, std::uint32_t index,
                                              const physics::World& world);

// The vertices of a rest shape on one side, ascending: those within 2 % of its extent, which is all of a flat end and
// nothing beside it. For round bodies (balls, rings, meshes) it is a cap of 10 %. kNone: all vertices.
[[nodiscard]] std::vector<std::uint16_t> FindSide(const BlueprintDefinition& definition,
                                                  const std::vector<physics::Vector3d>& rest, physics::Side side);

// Bodies of the scene, without players'.
[[nodiscard]] std::size_t CountBodies(const Scene& scene);

}  // namespace wobble::scenes
