#include "server/physics/shapes/recipe.h"

#include <algorithm>
#include <cassert>

#include "server/physics/shapes/tear.h"

namespace wobble::physics {

// Springs keep their order as others tear, so the i-th that is left is the i-th whose mark is 0. Tearing twice is the
// same as tearing once what tore either time: every list only loses entries, and what follows from the lists is made
// anew each time.
void AddTorn(BlueprintRecipe& recipe, std::size_t springs, std::span<const std::uint8_t> torn) {
  recipe.torn.resize(springs, 0);
  auto next = torn.begin();
  for (std::uint8_t& mark : recipe.torn) {
    if (mark != 0) continue;
    assert(next != torn.end());
    mark = *next++ != 0 ? 1 : 0;
  }
  assert(next == torn.end());
}

std::optional<Blueprint> MakeFromRecipe(const Blueprint& base, const BlueprintRecipe& recipe, std::string& error) {
  Blueprint made = base;
  if (recipe.parts) {
    GraphEdit edit = SetParts(base, *recipe.parts);
    if (!edit.errors.empty()) {
      const FieldError& first = edit.errors.front();
      error = first.field + " " + first.value + ": must be " + first.range;
      return {};
    }
    made = std::move(edit.blueprint);
  }
  if (recipe.torn.empty()) return made;
  if (recipe.torn.size() != made.full.springs.size() || made.full.gas > 0) {
    error = "torn springs " + std::to_string(recipe.torn.size()) + ": must be one a spring, " +
            std::to_string(made.full.springs.size()) + ", of a body without gas";
    return {};
  }
  return MakeTornBlueprint(made, recipe.torn);
}

}  // namespace wobble::physics
