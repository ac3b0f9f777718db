// Recordings of bodies in play, frame by frame as the server captures them: the input of all codecs.
#pragma once

#include <cstdint>
#include <vector>

#include "server/physics/world.h"
#include "server/snapshots/capture.h"
#include "server/training/basis_training.h"
#include "tests/bench/codec/play.h"

namespace wobble::bench {

inline constexpr int kFrameHz = 30;

struct Recording {
  server::CapturedBlueprint blueprint;
  std::vector<physics::Face> faces;
  std::vector<protocol::wire::Obstacle> obstacles;
  // All bodies of each frame, kFrameHz frames a second, in the same order.
  std::vector<std::vector<server::CapturedBody>> frames;
  std::vector<double> speeds;        // of the centre, per body and frame, m/s
  std::vector<double> deformations;  // FindDeformation, per body and frame

  [[nodiscard]] std::size_t CountVertices() const { return blueprint.rest.size(); }
};

// Trains bases as a server does when it loads a scene with this body: on a separate play in a separate arena.
[[nodiscard]] server::Bases TrainBasesAsServer(const physics::Blueprint& blueprint);

// The fixed play: four balls of radius 1 m with 162 vertices between four walls. seconds: of play, after two of
// warm-up.
[[nodiscard]] Recording RecordBalls(Pattern pattern, std::uint64_t seed, double seconds, double gas = kPlayedGas);
// A cloth of 32 x 32 vertices that hangs by its two upper corners in gusts of wind, hit by thrown balls.
[[nodiscard]] Recording RecordCloth(std::uint64_t seed, double seconds);
// Four cubes of 64 vertices in the same play as the balls.
[[nodiscard]] Recording RecordLattices(Pattern pattern, std::uint64_t seed, double seconds);

// RMS over the vertices of the residual after the best rigid fit (centroid and nearest rotation of the rest shape), as
// a share of the body's size.
[[nodiscard]] double FindDeformation(const server::CapturedBody& body, const server::CapturedBlueprint& blueprint);

[[nodiscard]] double FindMedian(std::vector<double> values);

}  // namespace wobble::bench
