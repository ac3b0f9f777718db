// Builds solids. Each tetrahedron gives a quarter of its mass to each of its corners.
//
// Damping: with c = √(E/ρ), the speed of sound along a bar, and a the size of a cell, the viscosity is η = μ_L τ with
// τ = 2 ζ a/c. A bar that vibrates along itself loses 2 η (1 + 2ν²) ε'² a volume, which is E τ ε'² to within 10 % for
// any ν from 0 to 0.45; so a vibration of angular frequency ω is damped at ω τ/2 of critical: by ζ where ω a = c, and
// in proportion to its frequency elsewhere. Changes of volume are damped like other strains, not in proportion to their
// stiffness, which near ν = ½ would cost substeps.
#include "server/physics/shapes/solid.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "server/physics/contact/contact.h"
#include "server/physics/meshing/tetrahedral_mesh.h"
#include "server/physics/methods/elasticity.h"
#include "server/physics/methods/forces.h"
#include "server/physics/model/roots.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/shapes/material.h"
#include "server/physics/shapes/mesh.h"

namespace wobble::physics {
namespace {

// More would take seconds to fill, and give more vertices than are allowed anyway.
constexpr double kMostCubes = 20000;
// A body that is less than this share of its mesh has lost limbs.
constexpr double kLeastVolumeShare = 0.8;

std::vector<Vector3d> ScaleVertices(const SolidDefinition& d) {
  std::vector<Vector3d> scaled;
  for (const Vector3d& x : d.vertices) scaled.push_back(d.scale * x);
  return scaled;
}

bool HasFewEnoughCubes(const SolidDefinition& d) {
  return d.cellSize > 0 && d.scale > 0 && CountCubes(ScaleVertices(d), d.cellSize) <= kMostCubes;
}

TetrahedralMesh Fill(const SolidDefinition& d) {
  return d.faces.empty() ? FillBox(d.cells, d.cellSize) : FillSurface(ScaleVertices(d), d.faces, d.cellSize);
}

double SumVolumes(const TetrahedralMesh& mesh) {
  double sum = 0;
  for (const Corners& corners : mesh.tetrahedra) sum += FindVolume(mesh.vertices, corners);
  return sum;
}

double FindViscosity(const SolidDefinition& d) {
  return d.dampingRatio * d.cellSize * std::sqrt(d.youngModulus * d.density) / (1 + d.poissonRatio);
}

void FixEnd(const SolidDefinition& d, Blueprint& blueprint) {
  if (d.fixed == Side::kNone) return;
  const auto index = static_cast<std::size_t>(d.fixed) - static_cast<std::size_t>(Side::kLowX);
  const auto axis = static_cast<int>(index / 2);
  const double sign = index % 2 == 0 ? -1 : 1;
  double end = sign * blueprint.rest[0][axis];
  for (const Vector3d& x : blueprint.rest) end = std::max(end, sign * x[axis]);
  const double reach = d.cellSize * (d.faces.empty() ? 0.01 : 0.5);
  for (std::size_t i = 0; i < blueprint.rest.size(); ++i) {
    if (sign * blueprint.rest[i][axis] >= end - reach) blueprint.full.fixed.push_back(static_cast<std::uint16_t>(i));
  }
}

// The contact law damps for one mass: the mean of those that can touch.
double FindMeanSkinMass(const Coefficients<double>& body) {
  std::vector<bool> isOuter(body.masses.size(), false);
  for (const Face& face : body.faces) {
    for (const std::uint16_t vertex : face) isOuter[vertex] = true;
  }
  double sum = 0;
  int count = 0;
  for (std::size_t i = 0; i < isOuter.size(); ++i) {
    if (!isOuter[i]) continue;
    sum += body.masses[i];
    ++count;
  }
  return sum / count;
}

// Half of the shortest way through a box, m; of another body, half of the edge of a cube of its volume.
double FindHalfBreadth(const SolidDefinition& d, double volume) {
  return d.faces.empty() ? d.cellSize * *std::ranges::min_element(d.cells) / 2 : FindCubeRoot(volume) / 2;
}

Blueprint MakeFilled(const SolidDefinition& d, const TetrahedralMesh& mesh) {
  Blueprint blueprint;
  blueprint.name = d.name;
  blueprint.rest = mesh.vertices;
  Coefficients<double>& full = blueprint.full;
  full.masses.assign(mesh.vertices.size(), 0);
  full.solid = MakeSolidMaterial(d.youngModulus, d.poissonRatio, FindViscosity(d));
  for (const Corners& corners : mesh.tetrahedra) {
    std::array<std::uint16_t, 4> vertices{};
    for (std::size_t i = 0; i < 4; ++i) vertices[i] = static_cast<std::uint16_t>(corners[i]);
    full.tetrahedra.push_back(MakeTetrahedron(vertices, mesh.vertices));
    for (const std::uint16_t vertex : vertices) full.masses[vertex] += d.density * full.tetrahedra.back().volume / 4;
  }
  full.faces = FindSkin(mesh);
  FixEnd(d, blueprint);

  Material material;
  material.stiffness = d.youngModulus * d.cellSize / 2.5;  // of an edge's spring in a lattice of such cells
  material.friction = d.friction;
  material.rollingResistance = d.rollingResistance;
  material.restitution = d.restitution;
  material.contactStiffness = d.contactStiffness;
  full.contact = MakeContactParameters(material, FindMeanSkinMass(full), FindHalfBreadth(d, SumVolumes(mesh)));
  FinishBlueprint(blueprint);
  SetAim(blueprint);
  return blueprint;
}

void CheckBox(std::vector<FieldError>& errors, const SolidDefinition& d) {
  const auto isGood = [](int n) { return n >= 1 && n <= kMaxLatticeCells; };
  const std::string text =
      "[" + std::to_string(d.cells[0]) + ", " + std::to_string(d.cells[1]) + ", " + std::to_string(d.cells[2]) + "]";
  if (!std::ranges::all_of(d.cells, isGood)) {
    errors.push_back({"cells", text, "three whole numbers from 1 to " + std::to_string(kMaxLatticeCells)});
  } else if (CountBoxVertices(d.cells) > kMaxSolidVertices) {
    errors.push_back({"cells", text,
                      "fewer: " + std::to_string(CountBoxVertices(d.cells)) + " vertices; at most " +
                          std::to_string(kMaxSolidVertices)});
  }
}

// Errors name `file`, the scene's one field for the whole mesh, but for what another size of cells may mend.
void CheckSurface(std::vector<FieldError>& errors, const SolidDefinition& d) {
  const auto refuse = [&](const std::string& value, const std::string& range) {
    errors.push_back({"file", value, range});
  };
  if (d.vertices.size() > kMaxMeshVertices) {
    return refuse(std::to_string(d.vertices.size()) + " vertices", "at most " + std::to_string(kMaxMeshVertices));
  }
  for (const MeshFault& fault : FindMeshFaults(d.vertices, d.faces)) {
    refuse("face " + std::to_string(fault.face + 1) + " " + fault.what, "a mesh whose faces join side by side");
  }
  if (!errors.empty()) return;
  if (MakeTopology(d.faces, d.vertices.size()).isOpen) return refuse("an open mesh", "a closed one");
  if (!(ComputeVolume<double>(d.faces, d.vertices) > 0)) {
    return refuse("faces look inward", "a closed mesh whose faces are counter-clockwise seen from outside");
  }
  double reach = 0;
  for (const Vector3d& x : d.vertices) reach = std::max(reach, d.scale * (x - d.vertices[0]).norm());
  CheckField(errors, "scale", d.scale, reach >= 0.05 && reach <= 100, "what makes the mesh 0.05 to 100 m large");
  CheckField(errors, "cell_size", d.cellSize, HasFewEnoughCubes(d), "larger: the mesh would take too many cells");
}

// Checks what a surface was filled with.
void CheckFilled(std::vector<FieldError>& errors, const SolidDefinition& d, const TetrahedralMesh& mesh) {
  CheckField(
      errors, "cell_size", d.cellSize, mesh.vertices.size() <= kMaxSolidVertices,
      ("larger: " + std::to_string(mesh.vertices.size()) + " vertices; at most " + std::to_string(kMaxSolidVertices))
          .c_str());
  if (d.faces.empty()) return;
  const double volume = d.scale * d.scale * d.scale * ComputeVolume<double>(d.faces, d.vertices);
  CheckField(errors, "cell_size", d.cellSize, SumVolumes(mesh) >= kLeastVolumeShare * volume,
             "smaller: parts of the mesh are thinner than a cell and would be lost");
}

}  // namespace

std::size_t CountVertices(const SolidDefinition& d) {
  if (d.faces.empty()) return CountBoxVertices(d.cells);
  return HasFewEnoughCubes(d) ? Fill(d).vertices.size() : 0;
}

std::vector<FieldError> ValidateSolid(const SolidDefinition& d) {
  std::vector<FieldError> errors;
  if (d.faces.empty()) CheckBox(errors, d);
  CheckField(errors, "cell_size", d.cellSize, d.cellSize >= 0.02 && d.cellSize <= 50, "0.02 to 50 m");
  CheckField(errors, "scale", d.scale, d.scale >= 1e-3 && d.scale <= 1e3, "0.001 to 1000");
  CheckField(errors, "young_modulus", d.youngModulus, d.youngModulus > 0 && d.youngModulus <= 1e12,
             "above 0, up to 1e12 Pa");
  CheckField(errors, "poisson_ratio", d.poissonRatio, d.poissonRatio >= 0 && d.poissonRatio <= kMaxPoissonRatio,
             "0 to 0.45");
  CheckField(errors, "density", d.density, d.density >= 0.1 && d.density <= 1e5, "0.1 to 100000 kg/m³");
  CheckField(errors, "damping_ratio", d.dampingRatio, d.dampingRatio >= 0 && d.dampingRatio <= 2, "0 to 2");
  CheckField(errors, "friction", d.friction, d.friction >= 0 && d.friction <= 10, "0 to 10");
  CheckRollingResistance(errors, d.rollingResistance);
  CheckField(errors, "restitution", d.restitution, d.restitution >= 0 && d.restitution <= 1, "0 to 1");
  CheckField(errors, "contact_stiffness", d.contactStiffness, d.contactStiffness >= 0 && d.contactStiffness <= 1e9,
             "0 (4 x young_modulus x cell_size) to 1e9 N/m");
  if (!errors.empty()) return errors;
  if (!d.faces.empty()) CheckSurface(errors, d);
  if (!errors.empty()) return errors;

  const TetrahedralMesh mesh = Fill(d);
  CheckFilled(errors, d, mesh);
  if (!errors.empty()) return errors;
  CheckField(errors, "young_modulus", d.youngModulus, IsSlowEnough(MakeFilled(d, mesh)),
             "lower, or contact_stiffness or damping_ratio lower, or density or cell_size higher: the body would need "
             "more than 32 substeps a tick before it touches anything, or more than 64 on the ground");
  return errors;
}

Blueprint MakeSolid(const SolidDefinition& definition) {
  assert(CountVertices(definition) > 0);
  return MakeFilled(definition, Fill(definition));
}

}  // namespace wobble::physics
