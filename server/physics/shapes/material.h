// What bodies of springs have in common when they are made from physical quantities.
#pragma once

#include <cmath>
#include <vector>

#include "server/physics/model/blueprint.h"
#include "server/physics/shapes/finish_blueprint.h"

namespace wobble::physics {

// Springs keep at least this share of the length that they have at rest; shorter ones would leave a skin limp against
// bending.
inline constexpr double kMinRestShare = 0.3;

// Everything that is wrong with a material but its gas, and with its gas.
void CheckMaterial(std::vector<FieldError>& errors, const Material& material);
void CheckGas(std::vector<FieldError>& errors, const Material& material);
// Refuses a body that is too fast for its ticks.
void CheckStiffness(std::vector<FieldError>& errors, const Material& material, const Blueprint& blueprint);

// Of a spring between two vertices of `vertexMass`, N·s/m. Critical is c = 2 √(k μ) with the reduced mass μ = m/2.
[[nodiscard]] inline double FindDamping(double dampingRatio, double stiffness, double vertexMass) {
  return dampingRatio * 2 * std::sqrt(stiffness * vertexMass / 2);
}

// Gives neighbours a repulsion K_r/d⁴, N·m⁴, and shortens each spring by what balances it, so that the rest shape stays
// what it is. Before FinishBlueprint.
void SetRepulsion(Blueprint& blueprint, double repulsion);
// Whether every spring has kept kMinRestShare.
[[nodiscard]] bool HasLongEnoughSprings(const Blueprint& blueprint);

}  // namespace wobble::physics
