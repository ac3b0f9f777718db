// World::ReplaceBlueprint for a body whose vertices keep their numbers.
#pragma once

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "server/physics/world.h"

namespace wobble::physics {

// Keeps as many of the body's first vertices as both blueprints have.
inline bool ReplaceBlueprint(World& world, BodyId id, Blueprint blueprint) {
  const std::size_t before = world.BlueprintOf(world.ReadBody(id)).rest.size();
  std::vector<std::uint16_t> kept(std::min(before, blueprint.rest.size()));
  std::iota(kept.begin(), kept.end(), std::uint16_t{0});
  return world.ReplaceBlueprint(id, std::move(blueprint), kept);
}

}  // namespace wobble::physics
