// The model of a patch of a body, known to both ends, against which its shape is coded.
//
// A blueprint keeps the constants of its patches, so that neither end finds them again for each record.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "protocol/codec/basis.h"
#include "protocol/geometry.h"
#include "protocol/messages.h"

namespace wobble::protocol {

// One patch, as the shape codec takes it. A view: what it points to must outlive it.
struct PatchModel {
  std::span<const Vector3> rest;                   // in the body's frame, m; 1..kMaxPatchVertices
  float size = 1;                                  // of the blueprint, m; above 0
  const Basis* basis = nullptr;                    // of as many vertices; nullptr: coordinates are coded one by one
  std::span<const wire::Obstacle> obstacles = {};  // of the welcome
  float reach = 0;                                 // FindReach(rest), m; read only where there are obstacles
};

// The constants of one patch, kept with its blueprint.
struct PatchConstants {
  std::shared_ptr<const Basis> basis;  // nullptr: the blueprint came without bases
  float reach = 0;                     // FindReach of the patch, m
};

// The greatest distance of a rest vertex from the origin of the body's frame, m.
[[nodiscard]] float FindReach(std::span<const Vector3> rest);

// The constants of all patches of a rest shape, in order, still without bases.
[[nodiscard]] std::vector<PatchConstants> FindPatchConstants(std::span<const Vector3> rest);

// The model of patch `patch`, below patches.size(). rest, size and patches: all of the blueprint's, as
// FindPatchConstants(rest) made them. obstacles: of the welcome.
[[nodiscard]] PatchModel MakePatchModel(std::span<const Vector3> rest, float size,
                                        std::span<const PatchConstants> patches, std::size_t patch,
                                        std::span<const wire::Obstacle> obstacles);

}  // namespace wobble::protocol
