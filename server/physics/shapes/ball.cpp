// Builds balls. The radius that a scene states is the radius at rest, so the springs must be shorter than the edges
// they lie on by as much as the gas stretches them. A sphere of radius R whose rest lengths are all scaled by f is in
// balance when the virial of the forces vanishes: the gas gives Σ F·x = 3 (P − P₀) V, the springs −Σ k (ℓ − fℓ) ℓ,
// hence
//   1 − f = 3 (P − P₀) V / Σ k ℓ².
// The vertices of an icosphere are not all alike, so a short damped relaxation then finds the exact equilibrium.
#include "server/physics/shapes/ball.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>

#include "server/physics/methods/forces.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/shapes/material.h"
#include "server/physics/shapes/relax.h"

namespace wobble::physics {
namespace {

std::uint16_t FindMidpoint(std::uint16_t a, std::uint16_t b, Icosphere& sphere,
                           std::map<std::array<std::uint16_t, 2>, std::uint16_t>& midpoints) {
  const std::array<std::uint16_t, 2> edge{std::min(a, b), std::max(a, b)};
  const auto [entry, isNew] = midpoints.try_emplace(edge, static_cast<std::uint16_t>(sphere.vertices.size()));
  if (isNew) sphere.vertices.push_back((sphere.vertices[a] + sphere.vertices[b]).normalized());
  return entry->second;
}

Icosphere MakeIcosahedron() {
  Icosphere sphere;
  const double t = (1 + std::sqrt(5.0)) / 2;
  for (const auto& [x, y, z] : std::initializer_list<std::array<double, 3>>{{-1, t, 0},
                                                                            {1, t, 0},
                                                                            {-1, -t, 0},
                                                                            {1, -t, 0},
                                                                            {0, -1, t},
                                                                            {0, 1, t},
                                                                            {0, -1, -t},
                                                                            {0, 1, -t},
                                                                            {t, 0, -1},
                                                                            {t, 0, 1},
                                                                            {-t, 0, -1},
                                                                            {-t, 0, 1}}) {
    sphere.vertices.push_back(Vector3d(x, y, z).normalized());
  }
  sphere.faces = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                  {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                  {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  return sphere;
}

double SumSquaredLengths(const Icosphere& sphere) {
  double sum = 0;
  for (const auto& [a, b] : sphere.edges) sum += (sphere.vertices[a] - sphere.vertices[b]).squaredNorm();
  return sum;
}

// 1 − f of the head comment.
double FindShortening(const BallDefinition& definition, const Icosphere& sphere) {
  const double r = definition.radius;
  const double volume = ComputeVolume<double>(sphere.faces, sphere.vertices) * r * r * r;
  const double pressure = definition.material.gas / volume - definition.material.ambientPressure;
  return 3 * pressure * volume / (definition.material.stiffness * SumSquaredLengths(sphere) * r * r);
}

}  // namespace

Icosphere MakeIcosphere(int subdivisions) {
  assert(subdivisions >= 0 && subdivisions <= kMaxSubdivisions);
  Icosphere sphere = MakeIcosahedron();
  for (int level = 0; level < subdivisions; ++level) {
    std::map<std::array<std::uint16_t, 2>, std::uint16_t> midpoints;
    std::vector<Face> finer;
    finer.reserve(4 * sphere.faces.size());
    for (const Face& face : std::vector<Face>(sphere.faces)) {
      const std::uint16_t ab = FindMidpoint(face[0], face[1], sphere, midpoints);
      const std::uint16_t bc = FindMidpoint(face[1], face[2], sphere, midpoints);
      const std::uint16_t ca = FindMidpoint(face[2], face[0], sphere, midpoints);
      finer.push_back({face[0], ab, ca});
      finer.push_back({face[1], bc, ab});
      finer.push_back({face[2], ca, bc});
      finer.push_back({ab, bc, ca});
    }
    sphere.faces = std::move(finer);
  }
  for (const Face& face : sphere.faces) {
    for (int side = 0; side < 3; ++side) {
      const std::uint16_t a = face[side];
      const std::uint16_t b = face[(side + 1) % 3];
      if (a < b) sphere.edges.push_back({a, b});  // the neighbouring face walks it from b to a
    }
  }
  std::sort(sphere.edges.begin(), sphere.edges.end());
  return sphere;
}

std::vector<FieldError> ValidateBall(const BallDefinition& d) {
  std::vector<FieldError> errors;
  const Material& m = d.material;
  CheckField(errors, "subdivisions", d.subdivisions, d.subdivisions >= 0 && d.subdivisions <= kMaxSubdivisions,
             "0 to 5");
  CheckField(errors, "radius", d.radius, d.radius >= 0.05 && d.radius <= 50, "0.05 to 50 m");
  CheckMaterial(errors, m);
  CheckGas(errors, m);
  if (!errors.empty()) return errors;

  const double shortening = FindShortening(d, MakeIcosphere(d.subdivisions));
  if (shortening > 1 - kMinRestShare || shortening < 0) {
    const double balanced = m.gas * (1 - kMinRestShare) / shortening;
    CheckField(errors, "gas", m.gas, false,
               shortening < 0 ? "more, or ambient_pressure lower: the skin would be crushed"
                              : ("at most " + std::to_string(static_cast<int>(balanced)) +
                                 " J for this radius, stiffness and ambient_pressure, or its springs would vanish")
                                    .c_str());
    return errors;
  }
  CheckStiffness(errors, m, MakeBall(d));
  return errors;
}

Blueprint MakeBall(const BallDefinition& definition) {
  const Icosphere sphere = MakeIcosphere(definition.subdivisions);
  const Material& material = definition.material;
  const double vertexMass = material.mass / static_cast<double>(sphere.vertices.size());
  const double restShare = 1 - FindShortening(definition, sphere);
  const double damping = FindDamping(material.dampingRatio, material.stiffness, vertexMass);

  Blueprint blueprint;
  blueprint.name = definition.name;
  double meanLength = 0;
  for (const Vector3d& x : sphere.vertices) blueprint.rest.push_back(definition.radius * x);
  for (const auto& [a, b] : sphere.edges) {
    const double length = (blueprint.rest[a] - blueprint.rest[b]).norm();
    meanLength += length / static_cast<double>(sphere.edges.size());
    blueprint.full.springs.push_back(
        {.a = a, .b = b, .restLength = restShare * length, .stiffness = material.stiffness, .damping = damping});
  }
  blueprint.full.faces = sphere.faces;
  blueprint.full.masses.assign(sphere.vertices.size(), vertexMass);
  blueprint.full.gas = material.gas;
  blueprint.full.ambientPressure = material.ambientPressure;
  blueprint.gasDampingRatio = material.FindGasDampingRatio();
  blueprint.full.drag = material.drag;
  SetRepulsion(blueprint, material.repulsion);
  blueprint.full.contact = MakeContactParameters(material, vertexMass, definition.radius);
  FinishBlueprint(blueprint);
  if (material.gas > 0) {
    // Relaxes until the forces are rounding errors of what a spring carries.
    const double tolerance = 1e-10 * material.stiffness * meanLength * blueprint.full.inverseMasses[0];
    (void)RelaxRest(blueprint, tolerance, 4000);
    FinishBlueprint(blueprint);
    SetAim(blueprint, true);
  }
  return blueprint;
}

}  // namespace wobble::physics
