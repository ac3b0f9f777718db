// Single bodies stepped as the server steps them, one second at a time.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "server/physics/world.h"
#include "tests/bench/accuracy/equations.h"

namespace wobble::bench {

inline constexpr int kTicksASecond = 60;
inline constexpr int kEvaluationsAStep = 4;  // force evaluations of an RK4 step

struct PlayedCase {
  std::string name;
  std::shared_ptr<const physics::Blueprint> blueprint;
  Equations equations;      // of *blueprint, with the gravity and obstacles of the case
  std::vector<Vector3d> x;  // initial positions, m
  std::vector<Vector3d> v;  // initial velocities, m/s
  bool isWellPosed = true;  // nearby motions are still nearby after a second
};

// The cases for which the step choice was designed: balls, lattices, cloths and rings, damped and undamped, vibrating,
// in flight, and bouncing without friction (friction would leave anchors, which Equations does not model). quick: a
// subset.
[[nodiscard]] std::vector<PlayedCase> MakePlayedCases(bool quick);

// One second of a body's play.
struct PlayedSecond {
  physics::State<float> begin;
  physics::State<float> end;
  physics::State<double> endInDouble;  // from the same beginning in a world of double precision
  std::uint64_t substeps = 0;          // repeated substeps included
  bool asleep = false;                 // at the end of the second
};
[[nodiscard]] std::vector<PlayedSecond> PlayAsServer(const PlayedCase& played, double errorTarget, int seconds);

// Positions in world coordinates, m, and velocities, m/s, of a state.
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
