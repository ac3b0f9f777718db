// One function per kind of body reads its fields. Quantities with a range that the physics knows are read unchecked and
// then validated by the physics; what only the file knows (counts, words, list elements) is checked here.
#include "server/scenes/blueprint_reader.h"

#include <algorithm>
#include <cstdio>
#include <map>
#include <tuple>

#include "server/physics/shapes/finish_blueprint.h"
#include "server/scenes/obj_reader.h"

namespace wobble::scenes {
namespace {

// One more would be refused for its vertices, but only after the seconds that it takes to find its stiffness.
constexpr int kMaxHostedSubdivisions = 4;
static_assert(kMaxHostedSubdivisions < physics::kMaxSubdivisions);

void ReadMethods(TableReader& reader, Methods& methods) {
  using physics::ContactLaw;
  ReadIntegrator(reader, methods.integrator);
  static const std::map<std::string, ContactLaw> kLaws{{"penalty", ContactLaw::kPenalty},
                                                       {"magnetic", ContactLaw::kMagnetic},
                                                       {"backtracking", ContactLaw::kBacktracking}};
  reader.Read("contact_law", kLaws, methods.contactLaw);
  reader.Read("magnetic_strength", physics::kMinMagneticStrength, physics::kMaxMagneticStrength, " N·m²",
              methods.magneticStrength);
  if (reader.Has("magnetic_strength") && methods.contactLaw != ContactLaw::kMagnetic) {
    reader.RefuseAsWritten("magnetic_strength", "", "left out unless contact_law is \"magnetic\"");
  }
}

// The physics knows the ranges of these quantities; Validate checks them.
void ReadMaterial(TableReader& reader, physics::Material& material) {
  reader.ReadUnchecked("mass", material.mass);
  reader.ReadUnchecked("stiffness", material.stiffness);
  reader.ReadUnchecked("damping_ratio", material.dampingRatio);
  reader.ReadUnchecked("friction", material.friction);
  reader.ReadUnchecked("rolling_resistance", material.rollingResistance);
  reader.ReadUnchecked("restitution", material.restitution);
  reader.ReadUnchecked("contact_stiffness", material.contactStiffness);
  reader.ReadUnchecked("repulsion", material.repulsion);
}

void ReadGas(TableReader& reader, physics::Material& material) {
  reader.ReadUnchecked("gas", material.gas);
  reader.ReadUnchecked("ambient_pressure", material.ambientPressure);
  double ratio = 0;
  reader.ReadUnchecked("gas_damping_ratio", ratio);
  if (reader.Has("gas_damping_ratio")) material.gasDampingRatio = ratio;
}

void ReadFields(TableReader& reader, physics::BallDefinition& ball) {
  reader.Read("subdivisions", 0, kMaxHostedSubdivisions, ball.subdivisions);
  reader.ReadUnchecked("radius", ball.radius);
  ReadMaterial(reader, ball.material);
  ReadGas(reader, ball.material);
  reader.ReadUnchecked("drag", ball.material.drag);
}

void ReadFields(TableReader& reader, physics::PairDefinition& pair) {
  reader.ReadUnchecked("length", pair.length);
  reader.Read("direction", -1, 1, "", pair.direction);
  reader.ReadUnchecked("radius", pair.radius);
  reader.Read("first_is_fixed", pair.firstIsFixed);
  ReadMaterial(reader, pair.material);
}

void ReadSide(TableReader& reader, physics::Side& side) {
  using physics::Side;
  static const std::map<std::string, Side> kSides{{"none", Side::kNone}, {"x-", Side::kLowX},  {"x+", Side::kHighX},
                                                  {"y-", Side::kLowY},   {"y+", Side::kHighY}, {"z-", Side::kLowZ},
                                                  {"z+", Side::kHighZ}};
  reader.Read("fixed", kSides, side);
}

// The fields that lattices and solids have in common.
template <class Definition>
void ReadElasticMaterial(TableReader& reader, Definition& body) {
  reader.ReadUnchecked("young_modulus", body.youngModulus);
  reader.ReadUnchecked("poisson_ratio", body.poissonRatio);
  reader.ReadUnchecked("density", body.density);
  reader.ReadUnchecked("damping_ratio", body.dampingRatio);
  reader.ReadUnchecked("friction", body.friction);
  reader.ReadUnchecked("rolling_resistance", body.rollingResistance);
  reader.ReadUnchecked("restitution", body.restitution);
  reader.ReadUnchecked("contact_stiffness", body.contactStiffness);
}

void ReadFields(TableReader& reader, physics::LatticeDefinition& lattice) {
  reader.Read("cells", 0, physics::kMaxLatticeCells, lattice.cells);
  lattice.poissonRatio = physics::FindPoissonRatio(lattice.cells);
  reader.ReadUnchecked("cell_size", lattice.cellSize);
  ReadElasticMaterial(reader, lattice);
  reader.ReadUnchecked("repulsion", lattice.repulsion);
  ReadSide(reader, lattice.fixed);
}

void ReadFields(TableReader& reader, physics::RingDefinition& ring) {
  reader.Read("points", 3, physics::kMaxRingPoints, ring.points);
  reader.Read("layers", 1, physics::kMaxRingLayers, ring.layers);
  reader.ReadUnchecked("radius", ring.radius);
  reader.ReadUnchecked("thickness", ring.thickness);
  ReadMaterial(reader, ring.material);
  ReadGas(reader, ring.material);
}

void ReadFields(TableReader& reader, physics::ClothDefinition& cloth) {
  using physics::Orientation;
  using physics::Pinned;
  reader.Read("points", 2, physics::kMaxClothPoints, cloth.points);
  reader.ReadUnchecked("spacing", cloth.spacing);
  reader.Read("orientation",
              std::map<std::string, Orientation>{{"horizontal", Orientation::kHorizontal},
                                                 {"vertical", Orientation::kVertical}},
              cloth.orientation);
  reader.Read("pinned",
              std::map<std::string, Pinned>{{"none", Pinned::kNone},
                                            {"corners", Pinned::kCorners},
                                            {"top_corners", Pinned::kTopCorners},
                                            {"edge", Pinned::kEdge},
                                            {"frame", Pinned::kFrame},
                                            {"clamp", Pinned::kClamp}},
              cloth.pinned);
  reader.ReadUnchecked("shear", cloth.shear);
  reader.ReadUnchecked("bend", cloth.bend);
  reader.ReadUnchecked("bend_stiffness", cloth.bendStiffness);
  reader.ReadUnchecked("tear_stretch", cloth.tearStretch);
  ReadMaterial(reader, cloth.material);
  reader.ReadUnchecked("drag", cloth.material.drag);
}

// The ranges of list elements are checked here as well, because here each has its line.
void ReadFields(TableReader& reader, physics::GraphDefinition& graph) {
  reader.ReadTables("particle", [&](TableReader& table) {
    physics::Particle particle;
    table.Read("position", -100, 100, " m", particle.position);
    table.Read("mass", 0.001, 1e6, " kg", particle.mass);
    table.Read("fixed", particle.fixed);
    graph.particles.push_back(particle);
  });
  reader.ReadTables("spring", [&](TableReader& table) {
    physics::GraphSpring spring;
    std::array<int, 2> ends{spring.a, spring.b};
    table.Require("ends");
    table.Read("ends", 0, static_cast<int>(physics::kMaxParticles) - 1, ends);
    std::tie(spring.a, spring.b) = std::tie(ends[0], ends[1]);
    table.Read("stiffness", 1e-6, 1e9, " N/m", spring.stiffness);
    table.Read("damping", 0, 1e6, " N·s/m", spring.damping);
    table.Read("rest_length", 0, 500, " m", spring.restLength);
    graph.springs.push_back(spring);
  });
  reader.Read("planar", graph.planar);
  reader.ReadUnchecked("friction", graph.friction);
  reader.ReadUnchecked("rolling_resistance", graph.rollingResistance);
  reader.ReadUnchecked("restitution", graph.restitution);
  reader.ReadUnchecked("contact_stiffness", graph.contactStiffness);
  reader.ReadUnchecked("radius", graph.radius);
}

// Reads the file that `file` names. Returns false when there is no mesh against which the other fields could be
// checked.
bool ReadTriangles(TableReader& reader, const MeshReader& readMesh, std::vector<physics::Vector3d>& vertices,
                   std::vector<physics::Face>& faces) {
  std::string file;
  reader.Read("file", 256, file);
  if (file.empty()) return false;
  ObjMesh read = readMesh(file);
  for (const std::string& error : read.errors) reader.Refuse("file", file + ": " + error, "a mesh without mistakes");
  vertices = std::move(read.vertices);
  faces = std::move(read.faces);
  return read.errors.empty();
}

bool ReadMesh(TableReader& reader, const MeshReader& readMesh, physics::MeshDefinition& mesh) {
  reader.ReadUnchecked("scale", mesh.scale);
  reader.ReadUnchecked("bend", mesh.bend);
  ReadMaterial(reader, mesh.material);
  ReadGas(reader, mesh.material);
  reader.ReadUnchecked("drag", mesh.material.drag);
  reader.Require("file");
  return ReadTriangles(reader, readMesh, mesh.vertices, mesh.faces);
}

// A box, or what the mesh of a file encloses. Returns false as ReadTriangles does.
bool ReadSolid(TableReader& reader, const MeshReader& readMesh, physics::SolidDefinition& solid) {
  reader.Read("cells", 1, physics::kMaxLatticeCells, solid.cells);
  reader.ReadUnchecked("cell_size", solid.cellSize);
  reader.ReadUnchecked("scale", solid.scale);
  ReadElasticMaterial(reader, solid);
  ReadSide(reader, solid.fixed);
  const bool hasFile = reader.Has("file");
  if (hasFile && reader.Has("cells")) reader.RefuseAsWritten("cells", "", "left out where there is a file");
  if (!hasFile && reader.Has("scale")) reader.RefuseAsWritten("scale", "", "left out unless there is a file");
  return !hasFile || ReadTriangles(reader, readMesh, solid.vertices, solid.faces);
}

// Implicit Euler has no Jacobian of tetrahedra and hinges in its matrix, and position Verlet keeps springs alone at
// their lengths.
void CheckKnowsMoreThanSprings(TableReader& reader, physics::Integrator integrator, const std::string& what) {
  using physics::Integrator;
  if (integrator != Integrator::kImplicitEuler && integrator != Integrator::kPositionVerlet) return;
  reader.RefuseAsWritten("integrator",
                         integrator == Integrator::kImplicitEuler ? "\"implicit_euler\"" : "\"position_verlet\"",
                         "an explicit method other than position_verlet: these two know springs, not " + what);
}

}  // namespace

void ReadIntegrator(TableReader& reader, physics::Integrator& integrator) {
  using physics::Integrator;
  static const std::map<std::string, Integrator> kWords{
      {"rk4", Integrator::kRungeKutta4},
      {"explicit_euler", Integrator::kExplicitEuler},
      {"semi_implicit_euler", Integrator::kSemiImplicitEuler},
      {"velocity_verlet", Integrator::kVelocityVerlet},
      {"leap_frog", Integrator::kLeapFrog},
      {"position_verlet", Integrator::kPositionVerlet},
      {"implicit_euler", Integrator::kImplicitEuler},
  };
  reader.Read("integrator", kWords, integrator);
}

// Refuses a shell whose gas cannot carry its weight. Only the gas holds a shell open: its force over the area is P A =
// (nRT/V) A, at most about nRT/R. With nRT < m g R the shell lies flat however stiff its springs are, and a flat shell
// soon turns inside out.
void CheckCarriesItself(TableReader& reader, const BlueprintDefinition& definition, const physics::Vector3d& gravity) {
  const auto check = [&](const physics::Material& material, double radius) {
    const double least = material.mass * gravity.norm() * radius;
    if (!(material.gas > 0) || material.gas >= least) return;
    char range[80];
    std::snprintf(range, sizeof range, "0, or at least mass x gravity x radius, %.4g J: its own weight crushes it",
                  least);
    reader.RefuseAsWritten("gas", FormatNode(toml::value<double>(material.gas)), range);
  };
  if (const auto* ball = std::get_if<physics::BallDefinition>(&definition)) check(ball->material, ball->radius);
  if (const auto* ring = std::get_if<physics::RingDefinition>(&definition)) check(ring->material, ring->radius);
}

void ReadBlueprint(TableReader& reader, const MeshReader& readMesh, physics::Integrator defaultIntegrator,
                   Scene& scene) {
  const std::map<std::string, BlueprintDefinition> kinds{
      {"ball", physics::BallDefinition{}},   {"cloth", physics::ClothDefinition{}},
      {"graph", physics::GraphDefinition{}}, {"lattice", physics::LatticeDefinition{}},
      {"mesh", physics::MeshDefinition{}},   {"pair", physics::PairDefinition{}},
      {"ring", physics::RingDefinition{}},   {"solid", physics::SolidDefinition{}}};
  BlueprintDefinition definition = kinds.at("ball");
  const bool kindIsKnown = !reader.Has("kind") || reader.Read("kind", kinds, definition);
  reader.Require("name");
  std::visit([&](auto& one) { reader.Read("name", 64, one.name); }, definition);
  const auto taken = [&](const BlueprintDefinition& other) { return NameOf(other) == NameOf(definition); };
  if (std::any_of(scene.blueprints.begin(), scene.blueprints.end(), taken)) {
    reader.Refuse("name", NameOf(definition), "a name that no other blueprint has");
  }
  Methods methods;
  methods.integrator = defaultIntegrator;
  if (kindIsKnown) {
    bool isWhole = true;
    std::visit(
        [&]<class One>(One& one) {
          if constexpr (std::is_same_v<One, physics::MeshDefinition>) {
            isWhole = ReadMesh(reader, readMesh, one);
          } else if constexpr (std::is_same_v<One, physics::SolidDefinition>) {
            isWhole = ReadSolid(reader, readMesh, one);
          } else {
            ReadFields(reader, one);
          }
        },
        definition);
    ReadMethods(reader, methods);
    if (std::holds_alternative<physics::SolidDefinition>(definition)) {
      CheckKnowsMoreThanSprings(reader, methods.integrator, "tetrahedra");
    }
    const auto* cloth = std::get_if<physics::ClothDefinition>(&definition);
    if (cloth != nullptr && cloth->bendStiffness > 0) {
      CheckKnowsMoreThanSprings(reader, methods.integrator, "bend_stiffness");
    }
    const auto errors = isWhole ? Validate(definition) : std::vector<physics::FieldError>{};
    for (const physics::FieldError& error : errors) reader.RefuseAsWritten(error.field, error.value, error.range);
    if (isWhole && errors.empty()) CheckCarriesItself(reader, definition, scene.gravity);
  } else {
    reader.PassOver();
  }
  scene.blueprints.push_back(std::move(definition));
  scene.methods.push_back(methods);
}

void ReadBlueprintName(TableReader& reader, const Scene& scene, std::size_t& blueprint) {
  reader.Require("blueprint");
  std::map<std::string, std::size_t> names;
  for (std::size_t i = 0; i < scene.blueprints.size(); ++i) names[NameOf(scene.blueprints[i])] = i;
  reader.Read("blueprint", names, blueprint);
}

}  // namespace wobble::scenes
