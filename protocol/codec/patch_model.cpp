#include "protocol/codec/patch_model.h"

#include <cassert>

#include "protocol/snapshot.h"

namespace wobble::protocol {
namespace {

std::span<const Vector3> FindPatch(std::span<const Vector3> rest, std::size_t patch) {
  return rest.subspan(patch * kMaxPatchVertices, PatchSize(rest.size(), patch));
}

}  // namespace

float FindReach(std::span<const Vector3> rest) {
  float square = 0;
  for (const Vector3& v : rest) {
    const float each = Dot(v, v);
    if (each > square) square = each;
  }
  return std::sqrt(square);
}

std::vector<PatchConstants> FindPatchConstants(std::span<const Vector3> rest) {
  std::vector<PatchConstants> patches(PatchCount(rest.size()));
  for (std::size_t patch = 0; patch < patches.size(); ++patch) patches[patch].reach = FindReach(FindPatch(rest, patch));
  return patches;
}

PatchModel MakePatchModel(std::span<const Vector3> rest, float size, std::span<const PatchConstants> patches,
                          std::size_t patch, std::span<const wire::Obstacle> obstacles) {
  assert(patch < patches.size() && patches.size() == PatchCount(rest.size()));
  return {.rest = FindPatch(rest, patch),
          .size = size,
          .basis = patches[patch].basis.get(),
          .obstacles = obstacles,
          .reach = patches[patch].reach};
}

}  // namespace wobble::protocol
