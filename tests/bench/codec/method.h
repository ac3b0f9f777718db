// A way to code the frames of a recording, with one number that trades bits for error.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "protocol/geometry.h"
#include "protocol/shape_codec.h"
#include "tests/bench/codec/recording.h"

namespace wobble::bench {

using Shown = std::vector<std::vector<protocol::Vector3>>;  // vertices of each body in the world, m

// Codes the next frame of the recording, decodes it from these bytes and what was decoded before, and returns how many
// bytes it took, what tells the bodies apart included. `shown` has the recording's sizes.
using CodeFrame = std::function<std::size_t(std::size_t frame, Shown& shown)>;

struct Method {
  std::string name;
  std::vector<double> parameters;  // from coarse to fine
  std::function<CodeFrame(const Recording& recording, double parameter)> begin;
};

// What every method pays for a body in a frame beside its shape, as our snapshots have it: id, blueprint and patch, and
// the length of what is coded by itself. Heads of packets are left out, for all alike.
inline constexpr std::size_t kBodyBytes = 3;
[[nodiscard]] constexpr std::size_t AddHead(std::size_t payload) {
  return kBodyBytes + (payload < 128 ? 1 : 2) + payload;
}

// The format of Rigs of Rods' network play: a reference node in floats, the others in half floats relative to it.
[[nodiscard]] Method MakeRigsOfRods();
// Each body as a mesh, or as a cloud of points in order, at the best that Draco can do. parameter: bits a coordinate.
[[nodiscard]] Method MakeDracoMesh();
[[nodiscard]] Method MakeDracoPoints();
// parameter of these, and of all below: step of the grid, m.
// meshoptimizer's vertex codec, its output through zstd. isDelta: against the frame before.
[[nodiscard]] Method MakeMeshoptimizer(bool isDelta);
// 16-bit differences from the frame before through zstd. isTuned: of places about the body's centroid, which is sent
// beside them, signs in the lowest bit, and low and high bytes apart.
[[nodiscard]] Method MakeDeltaZstd(bool isTuned);
// Differences from the frame that was acknowledged last, 100 ms ago, through an adaptive arithmetic coder.
[[nodiscard]] Method MakeDeltaAcknowledged();
// Ours, whole or without what one of its parts brings. parameter: RMS error that is aimed at, share of the body's size.
enum class Without { kNothing, kBasis, kSurfaces };
[[nodiscard]] Method MakeOurs(Without without = Without::kNothing);
// What both ends know of a patch of the recording's body, which must outlive it.
[[nodiscard]] protocol::PatchModel FindModel(const Recording& recording, std::size_t patch);

}  // namespace wobble::bench
