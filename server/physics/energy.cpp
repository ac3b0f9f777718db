#include "server/physics/energy.h"

#include "server/physics/methods/bending.h"
#include "server/physics/methods/elasticity.h"

namespace wobble::physics {

Energy& operator+=(Energy& sum, const Energy& part) {
  sum.kinetic += part.kinetic;
  sum.gravity += part.gravity;
  sum.springs += part.springs;
  sum.gas += part.gas;
  return sum;
}

Energy ComputeEnergy(const World& world, const Body& body, std::vector<Vector3d>& scratch) {
  const Blueprint& blueprint = world.BlueprintOf(body);
  const Coefficients<double>& full = blueprint.full;
  const auto compute = [&](const auto& state) {
    const auto copy = [&scratch](const auto& vectors) -> std::span<const Vector3d> {
      scratch.clear();
      for (const auto& vector : vectors) scratch.push_back(vector.template cast<double>());
      return scratch;
    };
    Energy energy;
    energy.kinetic = ComputeKineticEnergy(full, copy(state.velocities));
    energy.gravity = -blueprint.totalMass * world.Settings().gravity.dot(FindCentre(blueprint, state));
    const std::span<const Vector3d> x = copy(state.positions);
    energy.springs = body.stiffnessFactor * (ComputeSpringEnergy(full, x, state.torn) + ComputeSolidEnergy(full, x) +
                                             ComputeBendingEnergy(full, x)) +
                     ComputeRepulsionEnergy(full, x, state.torn);
    energy.gas = ComputeGasEnergy(full, x, body.gasFactor);
    return energy;
  };
  return std::visit(compute, body.state);
}

}  // namespace wobble::physics
