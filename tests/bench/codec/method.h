// A method that codes the frames of a recording, with one parameter that trades bits for error.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "protocol/codec/shape_codec.h"
#include "protocol/geometry.h"
#include "tests/bench/codec/recording.h"

namespace wobble::bench {

using Shown = std::vector<std::vector<protocol::Vector3>>;  // vertices of each body in the world, m

// Codes the next frame, decodes it from these bytes and earlier decoded frames, writes the vertices to `shown` (sized
// as the recording) and returns the number of bytes, including those that identify the bodies.
using CodeFrame = std::function<std::size_t(std::size_t frame, Shown& shown)>;

struct Method {
  std::string name;
  std::vector<double> parameters;  // coarse to fine
  std::function<CodeFrame(const Recording& recording, double parameter)> begin;
};

// Bytes that every method pays per body and frame besides its shape, as in our snapshots: id, blueprint and patch, plus
// the length of the separately coded payload (AddHead). Packet headers are left out, because they are equal for all.
inline constexpr std::size_t kBodyBytes = 3;
[[nodiscard]] constexpr std::size_t AddHead(std::size_t payload) {
  return kBodyBytes + (payload < 128 ? 1 : 2) + payload;
}

// The network format of Rigs of Rods: a reference node in floats, the others as half floats relative to it.
[[nodiscard]] Method MakeRigsOfRods();
// Draco at its best compression: each body as a mesh, or as an ordered point cloud. parameter: bits per coordinate.
[[nodiscard]] Method MakeDracoMesh();
[[nodiscard]] Method MakeDracoPoints();
// meshoptimizer's vertex codec, its output compressed by zstd. isDelta: differences from the previous frame. parameter,
// here and in the next two: grid step, m.
[[nodiscard]] Method MakeMeshoptimizer(bool isDelta);
// 16-bit differences from the previous frame, compressed by zstd. isTuned: positions relative to the centroid, which is
// sent with them; sign in the lowest bit; low and high bytes separated.
[[nodiscard]] Method MakeDeltaZstd(bool isTuned);
// Differences from the last acknowledged frame, 100 ms old, coded by an adaptive arithmetic coder.
[[nodiscard]] Method MakeDeltaAcknowledged();
// Our codec, complete or without one of its parts. parameter: target RMS error as a share of the body's size.
enum class Without { kNothing, kBasis, kSurfaces };
[[nodiscard]] Method MakeOurs(Without without = Without::kNothing);
// The patch model that both ends know, for a patch of the recording's body; refers to `recording`, which must outlive
// it.
[[nodiscard]] protocol::PatchModel FindModel(const Recording& recording, std::size_t patch);

}  // namespace wobble::bench
