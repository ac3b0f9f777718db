// The worlds whose ticks are timed: balls of 162 vertices, apart on a floor or pressed together.
#pragma once

#include <memory>

#include "server/physics/world.h"
#include "tests/bench/throughput/replays.h"

namespace wobble::bench {

inline constexpr int kTicksToFall = 120;
inline constexpr int kTicksToPress = 150;

// 1 m, k = 750 N/m, 0.25 kg a vertex. gas: nRT, J; by default as firm as a ball for play.
[[nodiscard]] physics::Blueprint MakeTimedBall(double gas = 1000);

// Each ball takes exactly so many: no error is small enough for it, and more are not allowed. Only stability may ask
// for more, and rows say what was played.
[[nodiscard]] physics::WorldSettings FixSubsteps(int substeps, int threads = 1);

// Far enough from one another never to meet, dropped from different heights, so that from kTicksToFall on some of them
// press on the floor at any moment.
[[nodiscard]] std::unique_ptr<physics::World> MakeBallsApart(std::size_t count, const physics::WorldSettings& settings,
                                                             int ticks = kTicksToFall);
// Dropped on a grid of 2.1 m into a funnel that is as much too small for them as that of the scene `scrum`: from
// kTicksToPress on they press, climb and squeeze one another.
[[nodiscard]] std::unique_ptr<physics::World> MakeBallsInFunnel(std::size_t count,
                                                                const physics::WorldSettings& settings,
                                                                int ticks = kTicksToPress);
// The same balls in the same shapes and motions, but apart and in the air.
[[nodiscard]] std::unique_ptr<physics::World> MakeBallsFreed(const physics::World& world,
                                                             const physics::WorldSettings& settings);

// Goes on from `world`, which must outlive it.
[[nodiscard]] Replay MakeReplay(const physics::World& world, const physics::WorldSettings& settings, int ticks);

// What is played in the ticks of such a replay that count.
struct Played {
  double substeps = 0;     // of a body and tick, mean
  double allSubsteps = 0;  // with those that were stepped again
  double awake = 0;        // bodies, mean
};
[[nodiscard]] Played CountPlayed(const physics::World& world, const physics::WorldSettings& settings, int ticks);

}  // namespace wobble::bench
