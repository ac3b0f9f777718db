// How a blueprint that came about in play follows from one of the scene's: few bytes, from which the same blueprint can
// be made again, to the bit.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "server/physics/shapes/graph.h"

namespace wobble::physics {

struct BlueprintRecipe {
  std::uint8_t base = 0;            // slot of the scene's blueprint
  std::optional<GraphParts> parts;  // of a graph that was built on since
  // One a spring of the base, or of `parts`; not 0: it has torn, and the blueprint is without it. Empty: none has.
  std::vector<std::uint8_t> torn;
};

// Adds the springs that tear of the blueprint that the recipe makes. springs: of the recipe's base or parts. torn: one
// a spring that the recipe has left.
void AddTorn(BlueprintRecipe& recipe, std::size_t springs, std::span<const std::uint8_t> torn);

// The blueprint. Any recipe is safe; nullopt, and the reason in `error`, for one that cannot follow from the base.
[[nodiscard]] std::optional<Blueprint> MakeFromRecipe(const Blueprint& base, const BlueprintRecipe& recipe,
                                                      std::string& error);

}  // namespace wobble::physics
