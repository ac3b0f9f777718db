// Short motions in contact whose solution the methods are compared with: bounce, slide, stack, squeeze, cloth over
// ball.
//
// Half a second each: longer, a crowd of contacts that begin and end lets neighbouring motions part. The losses of a
// tick (gas, rolling) are left out, because only the engine has them, and they belong to its tick and not to a step.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/physics/world.h"

namespace wobble::bench {

struct ContactScene {
  struct Placed {
    std::uint8_t blueprint = 0;
    physics::Vector3d position = physics::Vector3d::Zero();  // of the centre, m
    physics::Vector3d velocity = physics::Vector3d::Zero();  // m/s
    physics::Vector3d spin = physics::Vector3d::Zero();      // rad/s
  };
  std::string name;  // in rows, and with '_' for ' ' in the names of plots
  std::vector<physics::Blueprint> blueprints;
  std::vector<physics::Obstacle> obstacles;  // planes
  std::vector<Placed> bodies;
  int ticks = 30;  // of kContactTick
};

[[nodiscard]] std::vector<ContactScene> MakeContactScenes();

// The scene before its first tick. isPlain: no lanes, for comparison with methods that have none.
[[nodiscard]] std::unique_ptr<physics::World> MakeSceneWorld(
    const ContactScene& scene, const physics::WorldSettings& settings,
    physics::Integrator integrator = physics::Integrator::kRungeKutta4, bool isPlain = false);

// Positions of all vertices of all bodies, one body after the other, m.
[[nodiscard]] std::vector<physics::Vector3d> ReadAllPositions(const physics::World& world);

// Root of the mean square distance between a and b, m.
[[nodiscard]] double FindRms(const std::vector<physics::Vector3d>& a, const std::vector<physics::Vector3d>& b);

}  // namespace wobble::bench
