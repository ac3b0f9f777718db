#include "server/physics/shapes/material.h"
#include "server/physics/shapes/finish_blueprint.h"

#include <algorithm>

namespace wobble::physics {

void CheckRollingResistance(std::vector<FieldError>& errors, double value) {
  CheckField(errors, "rolling_resistance", value, value >= 0 && value <= 1, "0 to 1");
}

void CheckRadius(std::vector<FieldError>& errors, double value) {
  CheckField(errors, "radius", value, value >= 0.001 && value <= 10, "0.001 to 10 m");
}

void CheckMaterial(std::vector<FieldError>& errors, const Material& m) {
  CheckField(errors, "mass", m.mass, m.mass >= 1e-3 && m.mass <= 1e6, "0.001 to 1000000 kg");
  CheckField(errors, "stiffness", m.stiffness, m.stiffness > 0 && m.stiffness <= 1e9, "above 0, up to 1e9 N/m");
  CheckField(errors, "damping_ratio", m.dampingRatio, m.dampingRatio >= 0 && m.dampingRatio <= 2, "0 to 2");
  CheckRollingResistance(errors, m.rollingResistance);
  CheckField(errors, "friction", m.friction, m.friction >= 0 && m.friction <= 10, "0 to 10");
  CheckField(errors, "restitution", m.restitution, m.restitution >= 0 && m.restitution <= 1, "0 to 1");
  CheckField(errors, "contact_stiffness", m.contactStiffness, m.contactStiffness >= 0 && m.contactStiffness <= 1e9,
             "0 (ten times stiffness) to 1e9 N/m");
  CheckField(errors, "drag", m.drag, m.drag >= 0 && m.drag <= 1000, "0 to 1000 kg/m³");
  CheckField(errors, "repulsion", m.repulsion, m.repulsion >= 0 && m.repulsion <= 1e6, "0 to 1e6 N·m⁴");
}

void CheckGas(std::vector<FieldError>& errors, const Material& m) {
  CheckField(errors, "gas", m.gas, m.gas >= 0 && m.gas <= 1e9, "0 to 1e9 J");
  const double ratio = m.FindGasDampingRatio();
  CheckField(errors, "gas_damping_ratio", ratio, ratio >= 0 && ratio <= 10, "0 to 10");
  CheckField(errors, "ambient_pressure", m.ambientPressure, m.ambientPressure >= 0 && m.ambientPressure <= 1e6,
             "0 to 1e6 Pa");
}

void CheckStiffness(std::vector<FieldError>& errors, const Material& material, const Blueprint& blueprint) {
  CheckField(errors, "repulsion", material.repulsion, material.repulsion == 0 || HasLongEnoughSprings(blueprint),
             "lower, or stiffness higher: springs that balance it would vanish");
  CheckField(
      errors, "stiffness", material.stiffness, IsSlowEnough(blueprint),
      "lower, or contact_stiffness lower, or mass higher: the body would need more than 32 substeps a tick before it "
      "touches anything, or more than 64 on the ground");
}

void SetRepulsion(Blueprint& blueprint, double repulsion) {
  blueprint.full.repulsion = repulsion;
  if (!(repulsion > 0)) return;
  for (Spring<double>& spring : blueprint.full.springs) {
    const double squared = (blueprint.rest[spring.a] - blueprint.rest[spring.b]).squaredNorm();
    spring.restLength -= repulsion / (spring.stiffness * squared * squared);
  }
}

bool HasLongEnoughSprings(const Blueprint& blueprint) {
  return std::ranges::all_of(blueprint.full.springs, [&](const Spring<double>& spring) {
    return spring.restLength >= kMinRestShare * (blueprint.rest[spring.a] - blueprint.rest[spring.b]).norm();
  });
}

}  // namespace wobble::physics
