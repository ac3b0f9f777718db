// Bodies on their own, stepped as the server steps them, second by second.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/physics/world.h"
#include "tests/bench/accuracy/equations.h"

namespace wobble::bench {

inline constexpr int kTicksASecond = 60;
inline constexpr int kEvaluationsAStep = 4;  // of all forces, by RK4

struct PlayedCase {
  std::string name;
  std::shared_ptr<const physics::Blueprint> blueprint;
  Equations equations;      // of *blueprint, with the case's gravity and obstacles
  std::vector<Vector3d> x;  // at the beginning, m
  std::vector<Vector3d> v;  // m/s
  bool isWellPosed = true;  // motions that begin nearly alike are so after a second
};

// What the step choice was made for: balls, lattices, cloths, rings; with damping and without; vibrating, in flight,
// and bouncing without friction, which would leave anchors that equations know nothing of. quick: some of them.
[[nodiscard]] std::vector<PlayedCase> MakePlayedCases(bool quick);

// One body for a second.
struct PlayedSecond {
  physics::State<float> begin;
  physics::State<float> end;
  physics::State<double> endInDouble;  // from the same beginning, by a world in double precision
  std::uint64_t substeps = 0;          // with those that were stepped again
  bool asleep = false;                 // at the end
};
[[nodiscard]] std::vector<PlayedSecond> PlayAsServer(const PlayedCase& played, double errorTarget, int seconds);

// In the world, m, and m/s.
template <class Real>
[[nodiscard]] std::vector<Vector3d> ReadPositions(const physics::State<Real>& state) {
  std::vector<Vector3d> positions;
  for (const auto& x : state.positions) positions.emplace_back(state.origin + x.template cast<double>());
  return positions;
}
template <class Real>
[[nodiscard]] std::vector<Vector3d> ReadVelocities(const physics::State<Real>& state) {
  std::vector<Vector3d> velocities;
  for (const auto& v : state.velocities) velocities.emplace_back(v.template cast<double>());
  return velocities;
}

}  // namespace wobble::bench
