// The fixed play of the codec and interpolation reports: players, arena and the rules by which players move.
#pragma once

#include <cstdint>
#include <vector>

#include "server/physics/model/blueprint.h"
#include "server/physics/world.h"
#include "tests/bench/random.h"

namespace wobble::bench {

// Every player changes its action after 0.25 to 1 s. kChase: runs at another player a third of the time, otherwise to a
// random place, and jumps. kRoam: runs to random places, inflates, seldom jumps; bases that are measured on kChase are
// trained on kRoam.
enum class Pattern { kChase, kRoam };

inline constexpr physics::ControlLimits kPlayLimits{.acceleration = 12, .speed = 4, .jumpSpeed = 3};

// A floor and four walls, 12 m apart.
[[nodiscard]] std::vector<physics::Obstacle> MakeArena();

// nRT, J. With this value the play is as violent as the one for which the codec was chosen: median speed 3.5 m/s,
// deformation 3 to 5 % of the radius. The report has rows for softer and firmer balls.
inline constexpr double kPlayedGas = 4500;
// 162 vertices, radius 1 m, 0.25 kg per vertex, springs of 750 N/m, damped like the balls of the scene crowd.
[[nodiscard]] physics::Blueprint MakePlayedBall(double gas = kPlayedGas);

// One player. Each has its own random generator, so that the draws of one never shift those of another.
class Actor {
 public:
  // self: index of its body in the world.
  Actor(std::uint64_t seed, std::size_t self) : m_random(seed * 64 + self), m_self(self) {}

  // The player's control; call it once per tick of 1/60 s.
  [[nodiscard]] physics::Control Act(Pattern pattern, const physics::World& world);

 private:
  void TurnElsewhere(Pattern pattern, std::size_t count);

  Random m_random;
  std::size_t m_self;
  int m_ticksLeft = 0;
  std::size_t m_prey = 0;
  physics::Vector3d m_way = physics::Vector3d::Zero();
  bool m_hunts = false;
  bool m_puffs = false;
};

}  // namespace wobble::bench
