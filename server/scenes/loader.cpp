// Reads a scene table by table through TableReader, which checks type and range of each field, notes which keys were
// asked for, and at the end reports the others: a misspelt key is a mistake, not a default.
#include "server/scenes/loader.h"

#include <toml++/toml.h>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <map>
#include <set>
#include <sstream>

namespace wobble::scenes {
namespace {

using physics::Vector3d;

constexpr double kPlacesWithin = 4000;  // m from the origin: well inside what the protocol can show
constexpr std::size_t kMaxSceneBodies = 20000;

std::string FormatNumber(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

std::string FormatNode(const toml::node& node) {
  std::ostringstream text;
  node.visit([&](const auto& value) {
    if constexpr (toml::is_table<decltype(value)>) {
      text << "{...}";
    } else if constexpr (toml::is_floating_point<decltype(value)>) {
      char digits[32];  // the fewest that mean this number: 0.4, where a stream has 0.40000000000000002
      text << std::string_view(digits, std::to_chars(digits, digits + sizeof digits, *value).ptr);
    } else {
      text << value;
    }
  });
  return text.str();
}

class ErrorList {
 public:
  explicit ErrorList(std::string label) : m_label(std::move(label)) {}
  void Add(const toml::source_region& where, const std::string& what) {
    m_errors.emplace_back(where.begin.line, m_label + ":" + std::to_string(where.begin.line) + ": " + what);
  }
  // In the order of the file.
  std::vector<std::string> Take() {
    std::stable_sort(m_errors.begin(), m_errors.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<std::string> lines;
    for (auto& error : m_errors) lines.push_back(std::move(error.second));
    return lines;
  }
  [[nodiscard]] bool Empty() const { return m_errors.empty(); }

 private:
  std::string m_label;
  std::vector<std::pair<toml::source_index, std::string>> m_errors;
};

class TableReader {
 public:
  TableReader(const toml::table& table, ErrorList& errors) : m_table(table), m_errors(errors) {}

  [[nodiscard]] const toml::source_region& Where(std::string_view key) const {
    const toml::node* node = m_table.get(key);
    return node != nullptr ? node->source() : m_table.source();
  }
  void Refuse(std::string_view key, const std::string& value, const std::string& range) {
    m_errors.Add(Where(key), std::string(key) + " = " + value + ": must be " + range);
  }

  // As it stands in the file, when it does; a range that others know is checked against what was meant there.
  void RefuseAsWritten(std::string_view key, const std::string& value, const std::string& range) {
    const toml::node* node = m_table.get(key);
    if (node == nullptr) return Refuse(key, value, range);
    Refuse(key, FormatNode(*node), node->is_number() || node->is_array() ? range : "a number, " + range);
  }

  // A number whose range others check; what is no number becomes a NaN, which no range holds.
  void ReadUnchecked(std::string_view key, double& value) {
    const toml::node* node = Find(key);
    if (node == nullptr) return;
    value = node->value<double>().value_or(std::numeric_limits<double>::quiet_NaN());
  }

  void Read(std::string_view key, double low, double high, const char* unit, double& value) {
    const toml::node* node = Find(key);
    if (node == nullptr) return;
    const std::string range = FormatNumber(low) + " to " + FormatNumber(high) + unit;
    const auto number = node->value<double>();
    if (!number || !(*number >= low && *number <= high)) return RefuseAsWritten(key, "", range);
    value = *number;
  }

  void Read(std::string_view key, int low, int high, int& value) {
    const toml::node* node = Find(key);
    if (node == nullptr) return;
    const auto number = node->value_exact<std::int64_t>();
    if (!number || *number < low || *number > high) {
      return Refuse(key, FormatNode(*node),
                    "a whole number from " + std::to_string(low) + " to " + std::to_string(high));
    }
    value = static_cast<int>(*number);
  }

  void Read(std::string_view key, std::size_t maxLength, std::string& value) {
    const toml::node* node = Find(key);
    if (node == nullptr) return;
    const auto text = node->value_exact<std::string>();
    if (!text || text->empty() || text->size() > maxLength) {
      return Refuse(key, FormatNode(*node), "a text of 1 to " + std::to_string(maxLength) + " bytes");
    }
    value = *text;
  }

  void Read(std::string_view key, double low, double high, const char* unit, Vector3d& value) {
    const toml::node* node = Find(key);
    if (node == nullptr) return;
    const std::string range = "three numbers from " + FormatNumber(low) + " to " + FormatNumber(high) + unit;
    const toml::array* array = node->as_array();
    if (array == nullptr || array->size() != 3) return Refuse(key, FormatNode(*node), range);
    Vector3d read;
    for (std::size_t i = 0; i < 3; ++i) {
      const auto number = (*array)[i].value<double>();
      if (!number || !(*number >= low && *number <= high)) return Refuse(key, FormatNode(*node), range);
      read[static_cast<Eigen::Index>(i)] = *number;
    }
    value = read;
  }

  void Read(std::string_view key, int low, int high, std::array<int, 3>& value) {
    const toml::node* node = Find(key);
    if (node == nullptr) return;
    std::array<int, 3> read{};
    const toml::array* array = node->as_array();
    bool valid = array != nullptr && array->size() == read.size();
    for (std::size_t i = 0; valid && i < read.size(); ++i) {
      const auto number = (*array)[i].value<std::int64_t>();
      valid = number && *number >= low && *number <= high;
      if (valid) read[i] = static_cast<int>(*number);
    }
    if (!valid) {
      return Refuse(key, FormatNode(*node),
                    "three whole numbers from " + std::to_string(low) + " to " + std::to_string(high));
    }
    value = read;
  }

  // One of a few words. False when there is none or another one.
  template <class Value>
  bool Read(std::string_view key, const std::map<std::string, Value>& words, Value& value) {
    const toml::node* node = Find(key);
    if (node == nullptr) return false;
    const auto text = node->value_exact<std::string>();
    const auto found = text ? words.find(*text) : words.end();
    if (found != words.end()) {
      value = found->second;
      return true;
    }
    std::string range;
    for (const auto& word : words) range += (range.empty() ? "one of: " : ", ") + word.first;
    Refuse(key, FormatNode(*node), range);
    return false;
  }

  // Calls read(TableReader&) for the table, or for every table of the array, under `key`.
  template <class ReadOne>
  void ReadTables(std::string_view key, ReadOne&& read) {
    const toml::node* node = Find(key);
    if (node == nullptr) return;
    if (const toml::table* table = node->as_table()) {
      TableReader reader(*table, m_errors);
      read(reader);
      reader.ReportUnknown();
    } else if (const toml::array* array = node->as_array(); array != nullptr && array->is_array_of_tables()) {
      for (const toml::node& element : *array) {
        TableReader reader(*element.as_table(), m_errors);
        read(reader);
        reader.ReportUnknown();
      }
    } else {
      Refuse(key, FormatNode(*node), "a table, [" + std::string(key) + "] or [[" + std::string(key) + "]]");
    }
  }

  [[nodiscard]] bool Has(std::string_view key) {
    m_known.emplace(key);
    return m_table.contains(key);
  }
  void Require(std::string_view key) {
    if (!Has(key)) m_errors.Add(m_table.source(), std::string(key) + " is missing");
  }

  // What the table may hold cannot be told, so nothing more is said of it.
  void PassOver() {
    for (const auto& [key, node] : m_table) m_known.emplace(key.str());
  }

  void ReportUnknown() {
    for (const auto& [key, node] : m_table) {
      if (m_known.contains(std::string(key.str()))) continue;
      std::string known;
      for (const std::string& name : m_known) known += (known.empty() ? "" : ", ") + name;
      m_errors.Add(key.source(), std::string(key.str()) + " is no field here; known: " + known);
    }
  }

 private:
  const toml::node* Find(std::string_view key) {
    m_known.emplace(key);
    return m_table.get(key);
  }

  const toml::table& m_table;
  ErrorList& m_errors;
  std::set<std::string> m_known;
};

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

void ReadObstacle(TableReader& reader, Scene& scene) {
  physics::Obstacle obstacle;
  using Kind = physics::Obstacle::Kind;
  reader.Require("kind");
  const std::map<std::string, Kind> kinds{{"plane", Kind::kPlane}, {"box", Kind::kBox}};
  if (!reader.Read("kind", kinds, obstacle.kind)) return reader.PassOver();
  reader.Read("friction", 0, 10, "", obstacle.friction);
  if (obstacle.kind == Kind::kPlane) {
    reader.Read("normal", -1, 1, "", obstacle.normal);
    if (const double length = obstacle.normal.norm(); length > 1e-6) {
      obstacle.normal /= length;
    } else {
      reader.Refuse("normal", "[0, 0, 0]", "a direction");
    }
    reader.Read("offset", -kPlacesWithin, kPlacesWithin, " m", obstacle.offset);
  } else {
    reader.Read("center", -kPlacesWithin, kPlacesWithin, " m", obstacle.centre);
    reader.Read("half_extents", physics::kMinHalfExtent, kPlacesWithin, " m", obstacle.halfExtents);
  }
  scene.obstacles.push_back(obstacle);
}

// The ranges of quantities are the physics' own and checked by Validate.
void ReadFields(TableReader& reader, physics::BallDefinition& ball) {
  physics::Material& material = ball.material;
  reader.Read("subdivisions", 0, physics::kMaxSubdivisions, ball.subdivisions);
  reader.ReadUnchecked("radius", ball.radius);
  reader.ReadUnchecked("mass", material.mass);
  reader.ReadUnchecked("stiffness", material.stiffness);
  reader.ReadUnchecked("damping_ratio", material.dampingRatio);
  reader.ReadUnchecked("gas", material.gas);
  reader.ReadUnchecked("ambient_pressure", material.ambientPressure);
  reader.ReadUnchecked("friction", material.friction);
  reader.ReadUnchecked("restitution", material.restitution);
  reader.ReadUnchecked("contact_stiffness", material.contactStiffness);
}

void ReadFields(TableReader& reader, physics::LatticeDefinition& lattice) {
  reader.Read("cells", 1, physics::kMaxLatticeCells, lattice.cells);
  reader.ReadUnchecked("cell_size", lattice.cellSize);
  reader.ReadUnchecked("young_modulus", lattice.youngModulus);
  reader.ReadUnchecked("poisson_ratio", lattice.poissonRatio);
  reader.ReadUnchecked("density", lattice.density);
  reader.ReadUnchecked("damping_ratio", lattice.dampingRatio);
  reader.ReadUnchecked("friction", lattice.friction);
  reader.ReadUnchecked("restitution", lattice.restitution);
  reader.ReadUnchecked("contact_stiffness", lattice.contactStiffness);
}

void ReadBlueprint(TableReader& reader, Scene& scene, physics::Integrator defaultIntegrator) {
  const std::map<std::string, BodyDefinition> kinds{{"ball", physics::BallDefinition{}},
                                                    {"lattice", physics::LatticeDefinition{}}};
  BodyDefinition definition = kinds.at("ball");
  const bool kindIsKnown = !reader.Has("kind") || reader.Read("kind", kinds, definition);
  reader.Require("name");
  std::visit([&](auto& one) { reader.Read("name", 64, one.name); }, definition);
  const auto taken = [&](const BodyDefinition& other) { return NameOf(other) == NameOf(definition); };
  if (std::any_of(scene.blueprints.begin(), scene.blueprints.end(), taken)) {
    reader.Refuse("name", NameOf(definition), "a name that no other blueprint has");
  }
  Methods methods;
  methods.integrator = defaultIntegrator;
  if (kindIsKnown) {
    std::visit([&](auto& one) { ReadFields(reader, one); }, definition);
    ReadMethods(reader, methods);
    for (const physics::FieldError& error : Validate(definition)) {
      reader.RefuseAsWritten(error.field, error.value, error.range);
    }
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

void ReadGroup(TableReader& reader, Scene& scene) {
  BodyGroup group;
  ReadBlueprintName(reader, scene, group.blueprint);
  reader.Read("position", -kPlacesWithin, kPlacesWithin, " m", group.position);
  reader.Read("count", 1, 1000, group.count);
  reader.Read("spacing", -100, 100, " m", group.spacing);
  reader.Read("jitter", 0, 10, " m", group.jitter);
  reader.Read("velocity", -50, 50, " m/s", group.velocity);
  scene.groups.push_back(group);
}

void ReadPlayer(TableReader& reader, Scene& scene) {
  PlayerRules& player = scene.player;
  ReadBlueprintName(reader, scene, player.blueprint);
  reader.Read("spawn", -kPlacesWithin, kPlacesWithin, " m", player.spawn);
  reader.Read("spawn_radius", 0, 1000, " m", player.spawnRadius);
  reader.Read("acceleration", 0, 200, " m/s²", player.limits.acceleration);
  reader.Read("speed", 0, 50, " m/s", player.limits.speed);
  reader.Read("jump_speed", 0, 50, " m/s", player.limits.jumpSpeed);
  reader.Read("puff", 1, 3, "", player.limits.puffFactor);
  reader.Read("stiffen", 1, 4, "", player.limits.stiffenFactor);
}

void ReadScene(TableReader& reader, Scene& scene) {
  using physics::Precision;
  reader.Read("description", 256, scene.description);
  reader.Read("gravity", -100, 100, " m/s²", scene.gravity);
  reader.Read("precision",
              std::map<std::string, Precision>{{"float", Precision::kSingle}, {"double", Precision::kDouble}},
              scene.precision);
  physics::Integrator integrator = physics::Integrator::kRungeKutta4;
  ReadIntegrator(reader, integrator);
  reader.Read("kill_height", -kPlacesWithin, kPlacesWithin, " m", scene.killHeight);
  reader.Require("blueprint");
  reader.Require("player");
  reader.ReadTables("obstacle", [&](TableReader& table) { ReadObstacle(table, scene); });
  reader.ReadTables("blueprint", [&](TableReader& table) { ReadBlueprint(table, scene, integrator); });
  reader.ReadTables("bodies", [&](TableReader& table) { ReadGroup(table, scene); });
  reader.ReadTables("player", [&](TableReader& table) { ReadPlayer(table, scene); });
  if (const std::size_t bodies = CountBodies(scene); bodies > kMaxSceneBodies) {
    reader.Refuse("bodies", std::to_string(bodies), "at most " + std::to_string(kMaxSceneBodies) + " in all");
  }
  reader.ReportUnknown();
}

}  // namespace

LoadResult ParseScene(const std::string& text, const std::string& label) {
  LoadResult result;
  result.scene.name = std::filesystem::path(label).stem().string();
  ErrorList errors(std::filesystem::path(label).filename().string());
  try {
    const toml::table table = toml::parse(text, label);
    TableReader reader(table, errors);
    ReadScene(reader, result.scene);
  } catch (const toml::parse_error& error) {
    errors.Add(error.source(), std::string(error.description()));
  }
  result.errors = errors.Take();
  return result;
}

LoadResult LoadScene(const std::string& nameOrPath, const std::filesystem::path& folder) {
  const bool isPath = nameOrPath.find('/') != std::string::npos || nameOrPath.ends_with(".toml");
  const std::filesystem::path path = isPath ? std::filesystem::path(nameOrPath) : folder / (nameOrPath + ".toml");
  std::ifstream file(path);
  std::stringstream text;
  if (!file || !(text << file.rdbuf())) {
    LoadResult result;
    std::string names;
    for (const SceneSummary& scene : ListScenes(folder)) names += (names.empty() ? "" : ", ") + scene.name;
    result.errors.push_back(isPath ? "scene file '" + nameOrPath + "' cannot be read"
                                   : "scene '" + nameOrPath + "' is not known; one of: " + names +
                                         ", or a path to a .toml file");
    return result;
  }
  return ParseScene(text.str(), path.string());
}

std::vector<SceneSummary> ListScenes(const std::filesystem::path& folder) {
  std::vector<SceneSummary> scenes;
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.path().extension() != ".toml") continue;
    const LoadResult loaded = LoadScene(entry.path().string(), folder);
    scenes.push_back({entry.path().stem().string(),
                      loaded.errors.empty() ? loaded.scene.description : "(has errors) " + loaded.errors.front()});
  }
  std::sort(scenes.begin(), scenes.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return scenes;
}

}  // namespace wobble::scenes
