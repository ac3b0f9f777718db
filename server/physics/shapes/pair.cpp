#include "server/physics/shapes/pair.h"

#include "server/physics/contact/contact.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/shapes/material.h"

namespace wobble::physics {

std::vector<FieldError> ValidatePair(const PairDefinition& d) {
  std::vector<FieldError> errors;
  CheckField(errors, "length", d.length, d.length >= 0.02 && d.length <= 50, "0.02 to 50 m");
  const double way = d.direction.norm();
  CheckField(errors, "direction", way, way >= 1e-6 && way <= 1e6, "a direction");
  CheckRadius(errors, d.radius);
  CheckMaterial(errors, d.material);
  if (errors.empty()) CheckStiffness(errors, d.material, MakePair(d));
  return errors;
}

Blueprint MakePair(const PairDefinition& definition) {
  const Material& material = definition.material;
  const double vertexMass = material.mass / 2;
  Blueprint blueprint;
  blueprint.name = definition.name;
  blueprint.rest = {Vector3d::Zero(), definition.length * definition.direction.normalized()};
  blueprint.full.masses = {vertexMass, vertexMass};
  if (definition.firstIsFixed) blueprint.full.fixed = {0};
  blueprint.full.springs = {{.a = 0,
                             .b = 1,
                             .restLength = definition.length,
                             .stiffness = material.stiffness,
                             .damping = FindDamping(material.dampingRatio, material.stiffness, vertexMass)}};
  blueprint.rodRadius = definition.radius;
  SetRepulsion(blueprint, material.repulsion);
  blueprint.full.contact = MakeContactParameters(material, vertexMass, definition.length / 2);
  FinishBlueprint(blueprint);
  return blueprint;
}

}  // namespace wobble::physics
