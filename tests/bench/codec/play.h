// The fixed play of the reports on the wire: who plays, in what arena, and what makes them run.
#pragma once

#include <cstdint>
#include <vector>

#include "server/physics/model/blueprint.h"
#include "server/physics/world.h"
#include "tests/bench/random.h"

namespace wobble::bench {

// Everybody does something else after a quarter to a whole second. kChase: runs at another one a third of the time,
// else somewhere, and jumps. kRoam: runs somewhere, puffs up, jumps seldom: what bases are trained on that are measured
// on kChase.
enum class Pattern { kChase, kRoam };

inline constexpr physics::ControlLimits kPlayLimits{.acceleration = 12, .speed = 4, .jumpSpeed = 3};

// A floor and four walls, 12 m apart.
[[nodiscard]] std::vector<physics::Obstacle> MakeArena();

// nRT, J. With this the play is as violent as the one that the codec was chosen on: a median of 3.5 m/s, and shapes 3
// to 5 % of the radius off; the report has rows for softer and firmer balls.
inline constexpr double kPlayedGas = 4500;
// 162 vertices, radius 1 m, 0.25 kg and springs of 750 N/m a vertex; damped like the balls of the scene crowd.
[[nodiscard]] physics::Blueprint MakePlayedBall(double gas = kPlayedGas);

// One of those who play, with draws of its own, so that what one does never shifts what another draws.
class Actor {
 public:
  // self: its place among the bodies.
  Actor(std::uint64_t seed, std::size_t self) : m_random(seed * 64 + self), m_self(self) {}

  // Once a tick of 1/60 s.
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
