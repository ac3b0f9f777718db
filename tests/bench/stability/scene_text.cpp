// Writes what scenes/blueprint_reader and scenes/obstacle_reader read, of the fields that random worlds draw.
#include "tests/bench/stability/scene_text.h"

#include <algorithm>
#include <cstdio>

namespace wobble::bench {
namespace {

using namespace physics;

std::string Format(double value) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

std::string Format(const Vector3d& value) {
  return "[" + Format(value.x()) + ", " + Format(value.y()) + ", " + Format(value.z()) + "]";
}

// Gathers `key = value` lines.
class Lines {
 public:
  void Begin(const std::string& header) { m_text += header + "\n"; }
  void Add(const char* key, const std::string& value) { m_text += std::string(key) + " = " + value + "\n"; }
  void Add(const char* key, double value) { Add(key, Format(value)); }
  void Add(const char* key, const Vector3d& value) { Add(key, Format(value)); }
  void AddWhole(const char* key, int value) { Add(key, std::to_string(value)); }
  void AddWord(const char* key, const std::string& word) { Add(key, '"' + word + '"'); }
  void AddFlag(const char* key, bool value) { Add(key, std::string(value ? "true" : "false")); }
  template <std::size_t size>
  void Add(const char* key, const std::array<int, size>& values) {
    std::string list;
    for (const int value : values) list += (list.empty() ? "[" : ", ") + std::to_string(value);
    Add(key, list + "]");
  }
  [[nodiscard]] std::string Take() { return std::move(m_text); }

 private:
  std::string m_text;
};

enum class With : std::uint8_t { kNothing, kDrag, kGas, kGasAndDrag };

void AddMaterial(Lines& lines, const Material& material, With with) {
  lines.Add("mass", material.mass);
  lines.Add("stiffness", material.stiffness);
  lines.Add("damping_ratio", material.dampingRatio);
  lines.Add("friction", material.friction);
  lines.Add("rolling_resistance", material.rollingResistance);
  lines.Add("restitution", material.restitution);
  lines.Add("contact_stiffness", material.contactStiffness);
  lines.Add("repulsion", material.repulsion);
  if (with == With::kDrag || with == With::kGasAndDrag) lines.Add("drag", material.drag);
  if (with != With::kGas && with != With::kGasAndDrag) return;
  lines.Add("gas", material.gas);
  lines.Add("ambient_pressure", material.ambientPressure);
  if (material.gasDampingRatio) lines.Add("gas_damping_ratio", *material.gasDampingRatio);
}

template <class Elastic>
void AddElastic(Lines& lines, const Elastic& body) {
  lines.Add("young_modulus", body.youngModulus);
  lines.Add("poisson_ratio", body.poissonRatio);
  lines.Add("density", body.density);
  lines.Add("damping_ratio", body.dampingRatio);
  lines.Add("friction", body.friction);
  lines.Add("rolling_resistance", body.rollingResistance);
  lines.Add("restitution", body.restitution);
  lines.Add("contact_stiffness", body.contactStiffness);
}

// Returns the kind.
const char* AddFields(Lines& lines, const BallDefinition& ball) {
  lines.AddWhole("subdivisions", ball.subdivisions);
  lines.Add("radius", ball.radius);
  AddMaterial(lines, ball.material, With::kGasAndDrag);
  return "ball";
}

const char* AddFields(Lines& lines, const LatticeDefinition& lattice) {
  lines.Add("cells", lattice.cells);
  lines.Add("cell_size", lattice.cellSize);
  AddElastic(lines, lattice);
  lines.Add("repulsion", lattice.repulsion);
  return "lattice";
}

const char* AddFields(Lines& lines, const PairDefinition& pair) {
  lines.Add("length", pair.length);
  lines.Add("direction", pair.direction);
  lines.Add("radius", pair.radius);
  lines.AddFlag("first_is_fixed", pair.firstIsFixed);
  AddMaterial(lines, pair.material, With::kNothing);
  return "pair";
}

const char* AddFields(Lines& lines, const RingDefinition& ring) {
  lines.AddWhole("points", ring.points);
  lines.AddWhole("layers", ring.layers);
  lines.Add("radius", ring.radius);
  lines.Add("thickness", ring.thickness);
  AddMaterial(lines, ring.material, With::kGas);
  return "ring";
}

const char* Name(Pinned pinned) {
  switch (pinned) {
    case Pinned::kNone:
      return "none";
    case Pinned::kCorners:
      return "corners";
    case Pinned::kTopCorners:
      return "top_corners";
    case Pinned::kEdge:
      return "edge";
    case Pinned::kFrame:
      return "frame";
    case Pinned::kClamp:
      return "clamp";
  }
  return "";
}

const char* AddFields(Lines& lines, const ClothDefinition& cloth) {
  lines.Add("points", cloth.points);
  lines.Add("spacing", cloth.spacing);
  lines.AddWord("orientation", cloth.orientation == Orientation::kHorizontal ? "horizontal" : "vertical");
  lines.AddWord("pinned", Name(cloth.pinned));
  lines.Add("shear", cloth.shear);
  lines.Add("bend", cloth.bend);
  lines.Add("bend_stiffness", cloth.bendStiffness);
  lines.Add("tear_stretch", cloth.tearStretch);
  AddMaterial(lines, cloth.material, With::kDrag);
  return "cloth";
}

const char* AddFields(Lines& lines, const GraphDefinition& graph) {
  lines.AddFlag("planar", graph.planar);
  lines.Add("friction", graph.friction);
  lines.Add("rolling_resistance", graph.rollingResistance);
  lines.Add("restitution", graph.restitution);
  lines.Add("contact_stiffness", graph.contactStiffness);
  lines.Add("radius", graph.radius);
  for (const Particle& particle : graph.particles) {
    lines.Begin("[[blueprint.particle]]");
    lines.Add("position", particle.position);
    lines.Add("mass", particle.mass);
    lines.AddFlag("fixed", particle.fixed);
  }
  for (const GraphSpring& spring : graph.springs) {
    lines.Begin("[[blueprint.spring]]");
    lines.Add("ends", std::array{spring.a, spring.b});
    lines.Add("stiffness", spring.stiffness);
    lines.Add("damping", spring.damping);
    lines.Add("rest_length", spring.restLength);
  }
  return "graph";
}

const char* AddFields(Lines& lines, const MeshDefinition& mesh) {
  lines.Add("scale", mesh.scale);
  lines.Add("bend", mesh.bend);
  AddMaterial(lines, mesh.material, With::kGasAndDrag);
  return "mesh";
}

const char* AddFields(Lines& lines, const SolidDefinition& solid) {
  if (solid.faces.empty()) {
    lines.Add("cells", solid.cells);
  } else {
    lines.Add("scale", solid.scale);
  }
  lines.Add("cell_size", solid.cellSize);
  AddElastic(lines, solid);
  return "solid";
}

std::string WriteObj(const std::vector<Vector3d>& vertices, const std::vector<Face>& faces) {
  std::string text;
  for (const Vector3d& v : vertices) text += "v " + Format(v.x()) + " " + Format(v.y()) + " " + Format(v.z()) + "\n";
  for (const Face& face : faces) {
    text += "f";
    for (const std::uint16_t corner : face) text.append(1, ' ').append(std::to_string(corner + 1));
    text += "\n";
  }
  return text;
}

// Puts the mesh of a body that is made from one beside the text.
template <class Definition>
void AddMeshFile(Lines& lines, const Definition& definition, const std::string& name, scenes::SceneSource& source) {
  if constexpr (requires { definition.faces; }) {
    if (definition.faces.empty()) return;
    const std::string file = name + ".obj";
    source.meshes[file] = WriteObj(definition.vertices, definition.faces);
    lines.AddWord("file", file);
  }
}

void AddBlueprint(Lines& lines, const scenes::BlueprintDefinition& definition, const std::string& name,
                  scenes::SceneSource& source) {
  lines.Begin("[[blueprint]]");
  lines.AddWord("name", name);
  Lines fields;  // the kind is known behind them, and tables of their own come last
  const char* kind = std::visit([&](const auto& each) { return AddFields(fields, each); }, definition);
  lines.AddWord("kind", kind);
  std::visit([&](const auto& each) { AddMeshFile(lines, each, name, source); }, definition);
  lines.Begin(fields.Take());
}

void AddHeights(Lines& lines, const Terrain& terrain) {
  lines.Add("cell_size", terrain.cellSize);
  std::string rows;
  for (std::size_t i = 0; i < terrain.heights.size(); ++i) {
    const bool isRowsFirst = i % static_cast<std::size_t>(terrain.columns) == 0;
    rows += (i == 0 ? "[[" : isRowsFirst ? "],\n[" : ", ") + Format(terrain.heights[i]);
  }
  lines.Add("heights", rows + "]]");
}

void AddObstacle(Lines& lines, const Obstacle& obstacle, const Terrain& terrain) {
  using Kind = Obstacle::Kind;
  lines.Begin("[[obstacle]]");
  lines.Add("friction", obstacle.friction);
  switch (obstacle.kind) {
    case Kind::kPlane:
      lines.AddWord("kind", "plane");
      lines.Add("normal", obstacle.normal);
      return lines.Add("offset", obstacle.offset);
    case Kind::kBox:
      lines.AddWord("kind", "box");
      lines.Add("center", obstacle.centre);
      return lines.Add("half_extents", obstacle.halfExtents);
    case Kind::kSphere:
      lines.AddWord("kind", "sphere");
      lines.Add("center", obstacle.centre);
      return lines.Add("radius", obstacle.radius);
    case Kind::kCapsule:
      lines.AddWord("kind", "capsule");
      lines.Add("from", obstacle.centre);
      lines.Add("to", obstacle.end);
      return lines.Add("radius", obstacle.radius);
    case Kind::kHeightField:
      lines.AddWord("kind", "height_field");
      lines.Add("position", obstacle.centre);
      return AddHeights(lines, terrain);
  }
}

}  // namespace

scenes::SceneSource WriteScene(const RandomWorld& world, const std::string& name) {
  scenes::SceneSource source{.name = name, .text = {}, .meshes = {}};
  const WorldSettings& settings = world.Engine().Settings();
  Lines lines;
  lines.AddWord("description", "a random trial of wobble_lab: " + world.Place());
  lines.Begin("# The first keyframe has the gravity. Here it would have balls refused that it crushes.");
  lines.Add("gravity", Vector3d(0, 0, 0));
  lines.Add("wind", settings.wind);
  lines.AddWhole("kill_height", -4000);  // nothing comes back
  for (const Obstacle& obstacle : world.Engine().Obstacles()) AddObstacle(lines, obstacle, world.ReadTerrain());
  int number = 0;
  for (const scenes::BlueprintDefinition& definition : world.Definitions()) {
    AddBlueprint(lines, definition, "body" + std::to_string(++number), source);
  }
  lines.Begin("[player]");
  lines.AddWord("blueprint", "body1");
  lines.Begin("[tuning]");  // slopes tilt
  lines.AddWord("gravity", "host");
  source.text = lines.Take();
  return source;
}

}  // namespace wobble::bench
