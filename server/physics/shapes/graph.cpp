// Builds and changes graphs. Particles of a graph may move to any place, so a frequency that the power iteration finds
// in the rest shape does not hold for long: the squares of the frequencies of two springs add up when they are in line,
// not when they are at right angles. The frequency is bounded for every shape instead: the blocks of the matrix
// M^−½ K M^−½ are at most k n nᵀ/√(mᵢ mⱼ), so by Gershgorin's circles
//   ω² ≤ maxᵢ Σⱼ kᵢⱼ (1/mᵢ + 1/√(mᵢ mⱼ)),
// which is at most twice too large, and exact for a chain. It takes one pass over the springs, as suits a change while
// the world runs.
#include "server/physics/shapes/graph.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#include "server/physics/contact/contact.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/shapes/material.h"

namespace wobble::physics {
namespace {

constexpr double kParticleSize = 0.5;  // m; a contact's fade depth is a share of it

// maxᵢ Σⱼ of the formula above, with pick(spring) in place of kᵢⱼ.
template <class Pick>
double BoundRate(const Coefficients<double>& full, Pick&& pick) {
  std::vector<double> sums(full.masses.size(), 0);
  for (const Spring<double>& spring : full.springs) {
    const double a = full.inverseMasses[spring.a];
    const double b = full.inverseMasses[spring.b];
    sums[spring.a] += pick(spring) * (a + std::sqrt(a * b));
    sums[spring.b] += pick(spring) * (b + std::sqrt(a * b));
  }
  return sums.empty() ? 0 : *std::ranges::max_element(sums);
}

void BoundStability(Blueprint& graph) {
  graph.angularFrequency = std::sqrt(BoundRate(graph.full, [](const auto& spring) { return spring.stiffness; }));
  graph.dampingRate = BoundRate(graph.full, [](const auto& spring) { return spring.damping; });
}

void FinishGraph(Blueprint& graph) {
  FinishBlueprintButStability(graph);
  BoundStability(graph);
}

// where: precedes the name of each field in errors.
void CheckParticle(std::vector<FieldError>& errors, const std::string& where, const Particle& particle) {
  const double farthest =
      particle.position.allFinite() ? particle.position.cwiseAbs().maxCoeff() : std::numeric_limits<double>::infinity();
  CheckField(errors, (where + "position").c_str(), farthest, farthest <= 100, "within 100 m along each axis");
  CheckField(errors, (where + "mass").c_str(), particle.mass, particle.mass >= 1e-3 && particle.mass <= 1e6,
             "0.001 to 1000000 kg");
}

// Checks a spring between particles that exist.
void CheckQuantities(std::vector<FieldError>& errors, const std::string& where, const Spring<double>& spring) {
  CheckField(errors, (where + "stiffness").c_str(), spring.stiffness, spring.stiffness > 0 && spring.stiffness <= 1e9,
             "above 0, up to 1e9 N/m");
  CheckField(errors, (where + "damping").c_str(), spring.damping, spring.damping >= 0 && spring.damping <= 1e6,
             "0 to 1e6 N·s/m");
  CheckField(errors, (where + "rest_length").c_str(), spring.restLength,
             spring.restLength >= 1e-3 && spring.restLength <= 500, "0.001 to 500 m (0: what lies between its ends)");
}

bool IsJoined(const std::vector<Spring<double>>& springs, std::uint32_t a, std::uint32_t b) {
  return std::ranges::any_of(springs,
                             [&](const Spring<double>& s) { return (s.a == a && s.b == b) || (s.a == b && s.b == a); });
}

// Checks the spring, and adds it if its ends are valid.
void AppendSpring(std::vector<FieldError>& errors, const std::string& where, const GraphSpring& added,
                  Blueprint& graph) {
  const int count = static_cast<int>(graph.rest.size());
  const std::string ends = "[" + std::to_string(added.a) + ", " + std::to_string(added.b) + "]";
  if (added.a < 0 || added.a >= count || added.b < 0 || added.b >= count || added.a == added.b) {
    errors.push_back({where + "ends", ends, "two different particles from 0 to " + std::to_string(count - 1)});
    return;
  }
  const auto a = static_cast<std::uint32_t>(added.a);
  const auto b = static_cast<std::uint32_t>(added.b);
  if (IsJoined(graph.full.springs, a, b)) errors.push_back({where + "ends", ends, "two that no spring joins yet"});
  const double length = added.restLength == 0 ? (graph.rest[a] - graph.rest[b]).norm() : added.restLength;
  graph.full.springs.push_back(
      {.a = a, .b = b, .restLength = length, .stiffness = added.stiffness, .damping = added.damping});
  CheckQuantities(errors, where, graph.full.springs.back());
}

void AppendParticle(const Particle& added, Blueprint& graph) {
  Coefficients<double>& full = graph.full;
  if (added.fixed) full.fixed.push_back(static_cast<std::uint16_t>(graph.rest.size()));
  graph.rest.push_back(full.planar ? Vector3d(added.position.x(), 0, added.position.z()) : added.position);
  full.masses.push_back(added.mass);
}

GraphEdit BeginEdit(const Blueprint& graph) {
  GraphEdit edit{graph, {}, {}, {}};
  edit.keptParticles.resize(graph.rest.size());
  edit.keptSprings.resize(graph.full.springs.size());
  std::iota(edit.keptParticles.begin(), edit.keptParticles.end(), std::uint16_t{0});
  std::iota(edit.keptSprings.begin(), edit.keptSprings.end(), std::uint16_t{0});
  return edit;
}

// Returns whether the index is below `count`, else adds an error.
bool CheckPlace(GraphEdit& edit, const char* what, std::size_t index, std::size_t count) {
  if (index < count) return true;
  edit.errors.push_back({what, std::to_string(index), "one of " + std::to_string(count) + ", counted from 0"});
  return false;
}

Vector3d FindCentre(const Blueprint& graph, std::span<const Vector3d> positions) {
  assert(positions.size() == graph.rest.size());
  Vector3d moment = Vector3d::Zero();
  for (std::size_t i = 0; i < positions.size(); ++i) moment += graph.full.masses[i] * positions[i];
  return moment / graph.totalMass;
}

template <class Value>
void EraseAt(std::vector<Value>& values, std::size_t index) {
  values.erase(values.begin() + static_cast<std::ptrdiff_t>(index));
}

void CheckCounts(GraphEdit& edit) {
  const auto check = [&](const char* what, std::size_t count, std::size_t most) {
    CheckField(edit.errors, what, static_cast<double>(count), count <= most,
               ("at most " + std::to_string(most)).c_str());
  };
  check("particles", edit.blueprint.rest.size(), kMaxParticles);
  check("springs", edit.blueprint.full.springs.size(), kMaxGraphSprings);
}

// Checks the sizes and finishes the blueprint if there are no errors. field: the one that an error names when the body
// is too fast for its ticks.
void FinishEdit(GraphEdit& edit, const char* field, double value) {
  CheckCounts(edit);
  if (!edit.errors.empty()) return;
  FinishGraph(edit.blueprint);
  CheckField(edit.errors, field, value, IsSlowEnough(edit.blueprint),
             "softer, less damped or heavier: the body would need more than 32 substeps a tick, or more than 64 on the "
             "ground");
}

GraphEdit BuildGraph(const GraphDefinition& definition) {
  GraphEdit edit;
  Blueprint& graph = edit.blueprint;
  graph.name = definition.name;
  graph.full.planar = definition.planar;
  graph.rodRadius = definition.radius;
  CheckField(edit.errors, "friction", definition.friction, definition.friction >= 0 && definition.friction <= 10,
             "0 to 10");
  CheckRollingResistance(edit.errors, definition.rollingResistance);
  CheckRadius(edit.errors, definition.radius);
  CheckField(edit.errors, "restitution", definition.restitution,
             definition.restitution >= 0 && definition.restitution <= 1, "0 to 1");
  CheckField(edit.errors, "contact_stiffness", definition.contactStiffness,
             definition.contactStiffness > 0 && definition.contactStiffness <= 1e9, "above 0, up to 1e9 N/m");
  CheckField(edit.errors, "particles", 0, !definition.particles.empty(), "at least 1");
  double mass = 0;
  for (std::size_t i = 0; i < definition.particles.size(); ++i) {
    CheckParticle(edit.errors, "particle[" + std::to_string(i) + "].", definition.particles[i]);
    AppendParticle(definition.particles[i], graph);
    mass += definition.particles[i].mass / static_cast<double>(definition.particles.size());
  }
  for (std::size_t i = 0; i < definition.springs.size(); ++i) {
    AppendSpring(edit.errors, "spring[" + std::to_string(i) + "].", definition.springs[i], graph);
  }
  Material material;
  material.friction = definition.friction;
  material.rollingResistance = definition.rollingResistance;
  material.restitution = definition.restitution;
  material.contactStiffness = definition.contactStiffness;
  graph.full.contact = MakeContactParameters(material, mass, kParticleSize);
  double stiffest = 0;
  for (const Spring<double>& spring : graph.full.springs) stiffest = std::max(stiffest, spring.stiffness);
  FinishEdit(edit, "stiffness", stiffest);
  return edit;
}

}  // namespace

std::vector<FieldError> ValidateGraph(const GraphDefinition& definition) { return BuildGraph(definition).errors; }

Blueprint MakeGraph(const GraphDefinition& definition) { return BuildGraph(definition).blueprint; }

GraphParts FindParts(const Blueprint& graph) {
  return {.rest = graph.rest, .masses = graph.full.masses, .fixed = graph.full.fixed, .springs = graph.full.springs};
}

GraphEdit SetParts(const Blueprint& graph, const GraphParts& parts) {
  GraphEdit edit{graph, {}, {}, {}};
  const std::size_t count = parts.rest.size();
  Coefficients<double>& full = edit.blueprint.full;
  const bool isGraph = graph.rodRadius > 0 && full.faces.empty() && full.tetrahedra.empty();
  if (!isGraph) edit.errors.push_back({"parts", graph.name, "of a graph"});
  CheckField(edit.errors, "particles", static_cast<double>(count), count > 0, "at least 1");
  CheckField(edit.errors, "masses", static_cast<double>(parts.masses.size()), parts.masses.size() == count,
             "one a particle");
  const bool areFixed = std::ranges::is_sorted(parts.fixed, std::ranges::less_equal()) &&
                        (parts.fixed.empty() || parts.fixed.back() < count);
  CheckField(edit.errors, "fixed", static_cast<double>(parts.fixed.size()), areFixed, "places of particles, ascending");
  if (!edit.errors.empty()) return edit;
  edit.blueprint.rest = parts.rest;
  full.masses = parts.masses;
  full.fixed = parts.fixed;
  full.springs = parts.springs;
  CheckCounts(edit);
  if (!edit.errors.empty()) return edit;
  full.springs.clear();
  for (std::size_t i = 0; i < count; ++i) CheckParticle(edit.errors, "", {parts.rest[i], parts.masses[i], false});
  for (const Spring<double>& spring : parts.springs) {
    const GraphSpring added{.a = static_cast<int>(spring.a),
                            .b = static_cast<int>(spring.b),
                            .stiffness = spring.stiffness,
                            .damping = spring.damping,
                            .restLength = spring.restLength};
    AppendSpring(edit.errors, "", added, edit.blueprint);
  }
  if (!edit.errors.empty()) return edit;
  FinishCentredBlueprint(edit.blueprint);
  BoundStability(edit.blueprint);
  return edit;
}

GraphEdit AddParticle(const Blueprint& graph, const Particle& particle) {
  GraphEdit edit = BeginEdit(graph);
  CheckParticle(edit.errors, "", particle);
  AppendParticle(particle, edit.blueprint);
  FinishEdit(edit, "mass", particle.mass);
  return edit;
}

GraphEdit AddParticle(const Blueprint& graph, std::span<const Vector3d> positions, const Particle& particle) {
  GraphEdit edit = SetShape(graph, positions);
  if (!edit.errors.empty()) return edit;
  Particle local = particle;
  local.position -= FindCentre(graph, positions);
  return AddParticle(edit.blueprint, local);
}

GraphEdit AddSpring(const Blueprint& graph, const GraphSpring& spring) {
  GraphEdit edit = BeginEdit(graph);
  AppendSpring(edit.errors, "", spring, edit.blueprint);
  FinishEdit(edit, "stiffness", spring.stiffness);
  return edit;
}

GraphEdit SetSpring(const Blueprint& graph, std::size_t index, const GraphSpring& spring) {
  GraphEdit edit = BeginEdit(graph);
  if (!CheckPlace(edit, "spring", index, graph.full.springs.size())) return edit;
  Spring<double>& changed = edit.blueprint.full.springs[index];
  changed.stiffness = spring.stiffness;
  changed.damping = spring.damping;
  changed.restLength =
      spring.restLength == 0 ? (graph.rest[changed.a] - graph.rest[changed.b]).norm() : spring.restLength;
  CheckQuantities(edit.errors, "", changed);
  FinishEdit(edit, "stiffness", spring.stiffness);
  return edit;
}

GraphEdit SetMass(const Blueprint& graph, std::size_t particle, double mass) {
  GraphEdit edit = BeginEdit(graph);
  if (!CheckPlace(edit, "particle", particle, graph.rest.size())) return edit;
  edit.blueprint.full.masses[particle] = mass;
  CheckParticle(edit.errors, "", {graph.rest[particle], mass, false});
  FinishEdit(edit, "mass", mass);
  return edit;
}

GraphEdit SetFixed(const Blueprint& graph, std::size_t particle, bool fixed) {
  GraphEdit edit = BeginEdit(graph);
  if (!CheckPlace(edit, "particle", particle, graph.rest.size())) return edit;
  std::vector<std::uint16_t>& list = edit.blueprint.full.fixed;
  std::erase(list, particle);
  if (fixed) list.insert(std::ranges::lower_bound(list, particle), static_cast<std::uint16_t>(particle));
  FinishEdit(edit, "fixed", fixed ? 1 : 0);
  return edit;
}

GraphEdit SetShape(const Blueprint& graph, std::span<const Vector3d> positions) {
  GraphEdit edit = BeginEdit(graph);
  const Vector3d centre = FindCentre(graph, positions);
  for (std::size_t i = 0; i < positions.size(); ++i) {
    Vector3d& x = edit.blueprint.rest[i];
    x = positions[i] - centre;
    if (graph.full.planar) x.y() = 0;
    CheckParticle(edit.errors, "particle[" + std::to_string(i) + "].", {x, graph.full.masses[i], false});
  }
  FinishEdit(edit, "shape", 0);
  return edit;
}

GraphEdit RemoveParticle(const Blueprint& graph, std::size_t index) {
  GraphEdit edit = BeginEdit(graph);
  if (!CheckPlace(edit, "particle", index, graph.rest.size())) return edit;
  if (graph.rest.size() == 1) {
    edit.errors.push_back({"particles", "0", "at least 1"});
    return edit;
  }
  Coefficients<double>& full = edit.blueprint.full;
  EraseAt(edit.blueprint.rest, index);
  EraseAt(full.masses, index);
  EraseAt(edit.keptParticles, index);
  const auto endsIn = [index](const Spring<double>& spring) { return spring.a == index || spring.b == index; };
  std::erase_if(edit.keptSprings, [&](std::uint16_t spring) { return endsIn(graph.full.springs[spring]); });
  std::erase_if(full.springs, endsIn);
  for (Spring<double>& spring : full.springs) {
    spring.a -= spring.a > index ? 1 : 0;
    spring.b -= spring.b > index ? 1 : 0;
  }
  std::erase(full.fixed, index);
  for (std::uint16_t& fixed : full.fixed) fixed = static_cast<std::uint16_t>(fixed - (fixed > index ? 1 : 0));
  FinishEdit(edit, "particle", static_cast<double>(index));
  return edit;
}

GraphEdit RemoveSpring(const Blueprint& graph, std::size_t index) {
  GraphEdit edit = BeginEdit(graph);
  if (!CheckPlace(edit, "spring", index, graph.full.springs.size())) return edit;
  EraseAt(edit.blueprint.full.springs, index);
  EraseAt(edit.keptSprings, index);
  FinishEdit(edit, "spring", static_cast<double>(index));
  return edit;
}

}  // namespace wobble::physics
