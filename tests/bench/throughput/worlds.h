// The worlds whose ticks are timed: balls of 162 vertices, apart on a floor or pressed together.
#pragma once

#include <memory>

#include "server/physics/world.h"
#include "tests/bench/throughput/replays.h"

namespace wobble::bench {

inline constexpr int kTimedSubsteps = 4;
inline constexpr int kTimedTicks = 12;
inline constexpr int kTicksToFall = 120;
inline constexpr int kTicksToPress = 150;
inline constexpr int kTicksToChase = 300;

// A ball of radius 1 m, k = 750 N/m, 0.25 kg per vertex. gas: nRT, J; by default as firm as a ball for play.
[[nodiscard]] physics::Blueprint MakeTimedBall(double gas = 1000);

// Settings with exactly `substeps` substeps per ball: the error target is unreachable and more substeps are not
// allowed. Only the stability limit may ask for more; rows report the substeps that were played.
[[nodiscard]] physics::WorldSettings FixSubsteps(int substeps, int threads = 1);

// Balls that never meet, dropped from different heights, so that from kTicksToFall on some of them press on the floor
// at any moment.
[[nodiscard]] std::unique_ptr<physics::World> MakeBallsApart(std::size_t count, const physics::WorldSettings& settings,
                                                             int ticks = kTicksToFall);
// Balls dropped on a grid of 2.1 m into a funnel that is as much too small for them as that of the scene `scrum`: from
// kTicksToPress on they press, climb and squeeze one another.
[[nodiscard]] std::unique_ptr<physics::World> MakeBallsInFunnel(std::size_t count,
                                                                const physics::WorldSettings& settings,
                                                                int ticks = kTicksToPress);
// Players of the scene `pitch` who chase one another, with the ball that the scene gives them; afterwards their
// controls stay as they are. settings: those of the scene but for what is measured.
[[nodiscard]] std::unique_ptr<physics::World> MakePlayersChasing(std::size_t count,
                                                                 const physics::WorldSettings& settings,
                                                                 int ticks = kTicksToChase);
// The same balls with the same shapes and velocities, but apart and in the air.
[[nodiscard]] std::unique_ptr<physics::World> MakeBallsFreed(const physics::World& world,
                                                             const physics::WorldSettings& settings);

// A replay that continues from `world`, which must outlive it.
[[nodiscard]] Replay MakeReplay(const physics::World& world, const physics::WorldSettings& settings, int ticks);

// Means over the counted ticks of a replay.
struct Played {
  double substeps = 0;     // per body and tick
  double allSubsteps = 0;  // repeated substeps included
  double awake = 0;        // bodies
};
[[nodiscard]] Played CountPlayed(const physics::World& world, const physics::WorldSettings& settings, int ticks);

}  // namespace wobble::bench
