// What the makers of bodies from physical quantities share: checks of a material, damping, repulsion.
#pragma once

#include <cmath>
#include <vector>

#include "server/physics/model/blueprint.h"
#include "server/physics/shapes/finish_blueprint.h"

namespace wobble::physics {

// Least rest length of a spring, as a share of its length in the rest shape. With shorter ones a skin would be limp
// against bending.
inline constexpr double kMinRestShare = 0.3;

// Add an error for every bad field of a material except its gas, and for a bad gas.
void CheckMaterial(std::vector<FieldError>& errors, const Material& material);
void CheckGas(std::vector<FieldError>& errors, const Material& material);
void CheckRollingResistance(std::vector<FieldError>& errors, double value);
// Of particles and springs.
void CheckRadius(std::vector<FieldError>& errors, double value);
// Adds an error when the body is too fast for its ticks (IsSlowEnough).
void CheckStiffness(std::vector<FieldError>& errors, const Material& material, const Blueprint& blueprint);

// Damping, N·s/m, of a spring between two vertices of `vertexMass`, kg. dampingRatio: 1 is critical, c = 2 √(k μ) with
// the reduced mass μ = m/2.
[[nodiscard]] inline double FindDamping(double dampingRatio, double stiffness, double vertexMass) {
  return dampingRatio * 2 * std::sqrt(stiffness * vertexMass / 2);
}

// Lets neighbours at distance d repel with K_r/d⁴, K_r = repulsion, N·m⁴, and shortens each spring by what balances
// this, so that the rest shape stays the same. To be called before FinishBlueprint.
void SetRepulsion(Blueprint& blueprint, double repulsion);
// Whether every spring has at least kMinRestShare.
[[nodiscard]] bool HasLongEnoughSprings(const Blueprint& blueprint);

}  // namespace wobble::physics
