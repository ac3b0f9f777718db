// A draft of the blueprint is edited at once; the world gets it in Update. Between two updates the particles of the
// draft are the vertices m_kept of the body in the world, followed by the new ones at m_new.
#include "server/play/workshop.h"

#include <algorithm>
#include <numeric>

#include "server/physics/shapes/tear.h"

namespace wobble::server {
namespace {

using physics::GraphEdit;
using physics::Vector3d;

constexpr double kUpdateTime = 0.2;  // from one blueprint to the next, s
// The most changes within that time, of all players together: on a large graph each takes half a millisecond. Twenty
// sliders dragged at once stay below it.
constexpr int kMostChanges = 40;

constexpr const char* kProtected = "what others built is protected here";
constexpr const char* kBusy = "too many changes at once; try again";

std::ptrdiff_t Find(const std::vector<PartTag>& tags, std::uint16_t number) {
  const auto found = std::ranges::find(tags, number, &PartTag::number);
  return found == tags.end() ? -1 : found - tags.begin();
}

int CountOf(const std::vector<PartTag>& tags, ClientId client) {
  return static_cast<int>(std::ranges::count(tags, client, &PartTag::owner));
}

// Keeps the values at these indices, ascending, and drops the others.
template <class Value>
void Keep(std::vector<Value>& values, std::span<const std::uint16_t> kept) {
  for (std::size_t i = 0; i < kept.size(); ++i) values[i] = values[kept[i]];
  values.resize(kept.size());
}

std::string Describe(const std::vector<physics::FieldError>& errors) {
  const physics::FieldError& error = errors.front();
  return error.field + " " + error.value + ": must be " + error.range;
}

std::string MissingPart(const char* what, std::uint16_t number) {
  return std::string(what) + " " + std::to_string(number) + " no longer exists";
}

std::string AllUsed(const char* what, int most) {
  return "you have " + std::to_string(most) + " " + what + ", the most per player; remove one first";
}

}  // namespace

Workshop::Workshop(const scenes::WorkshopRules& rules, physics::BodyId body, const physics::World& world)
    : m_rules(rules), m_body(body), m_original(world.BlueprintOf(world.ReadBody(body))), m_draft(m_original) {
  TagAll();
  NoteShown();
}

void Workshop::TagAll() {
  m_particles.clear();
  m_springs.clear();
  for (std::size_t i = 0; i < m_draft.rest.size(); ++i) m_particles.push_back({FindNumber(), 0});
  for (std::size_t i = 0; i < m_draft.full.springs.size(); ++i) m_springs.push_back({FindNumber(), 0});
}

void Workshop::Reset(const Vector3d& home) {
  m_draft = m_original;
  TagAll();
  m_kept.clear();
  m_new.clear();
  for (const Vector3d& rest : m_original.rest) m_new.push_back(home + rest);
  m_changed = true;
}

void Workshop::NoteShown() {
  m_new.clear();
  m_kept.resize(m_particles.size());
  std::iota(m_kept.begin(), m_kept.end(), std::uint16_t{0});
  m_shownParticles = m_particles;
  m_shownSprings = m_springs;
  m_changed = false;
}

std::string Workshop::Build(const Builder& builder, const BuildCommand& command, const physics::World& world) {
  using Kind = BuildCommand::Kind;
  const ClientId client = builder.client;
  if (m_changes >= kMostChanges) return kBusy;
  if (command.kind == Kind::kAddParticle) return AddParticle(client, command, world);
  if (command.kind == Kind::kAddSpring) return AddSpring(client, command, world);
  const bool isSpring = command.kind == Kind::kSetSpring || command.kind == Kind::kRemoveSpring;
  const std::ptrdiff_t found = Find(isSpring ? m_springs : m_particles, command.a);
  if (found < 0) return MissingPart(isSpring ? "spring" : "particle", command.a);
  const auto place = static_cast<std::size_t>(found);
  const bool may = command.kind == Kind::kRemoveParticle
                       ? MayRemove(builder, place)
                       : MayChange(builder, isSpring ? m_springs[place] : m_particles[place]);
  if (!may) return kProtected;
  switch (command.kind) {
    case Kind::kSetSpring:
      return Take(
          SetSpring(m_draft, place,
                    {.stiffness = command.stiffness, .damping = command.damping, .restLength = command.restLength}),
          client);
    case Kind::kRemoveSpring:
      return Take(RemoveSpring(m_draft, place), client);
    case Kind::kRemoveParticle:
      return Take(RemoveParticle(m_draft, place), client);
    default:
      break;
  }
  GraphEdit edit = SetMass(m_draft, place, command.mass);
  if (edit.errors.empty()) edit = SetFixed(edit.blueprint, place, command.fixed);
  return Take(std::move(edit), client);
}

std::string Workshop::AddParticle(ClientId client, const BuildCommand& command, const physics::World& world) {
  if (CountOf(m_particles, client) >= m_rules.particlesEach) return AllUsed("particles", m_rules.particlesEach);
  const std::vector<Vector3d> places = FindPlaces(world);
  const Vector3d at = m_draft.full.planar ? Vector3d(command.at.x(), places[0].y(), command.at.z()) : command.at;
  std::string error = Take(physics::AddParticle(m_draft, places, {at, command.mass, command.fixed}), client);
  if (error.empty()) m_new.push_back(at);
  return error;
}

std::string Workshop::AddSpring(ClientId client, const BuildCommand& command, const physics::World& world) {
  if (CountOf(m_springs, client) >= m_rules.springsEach) return AllUsed("springs", m_rules.springsEach);
  const std::ptrdiff_t a = Find(m_particles, command.a);
  const std::ptrdiff_t b = Find(m_particles, command.b);
  if (a < 0 || b < 0) return MissingPart("particle", a < 0 ? command.a : command.b);
  physics::GraphSpring spring{.a = static_cast<int>(a),
                              .b = static_cast<int>(b),
                              .stiffness = command.stiffness,
                              .damping = command.damping,
                              .restLength = command.restLength};
  if (spring.restLength == 0) {  // the present distance, not that in the rest shape
    const std::vector<Vector3d> places = FindPlaces(world);
    spring.restLength = (places[static_cast<std::size_t>(a)] - places[static_cast<std::size_t>(b)]).norm();
  }
  return Take(physics::AddSpring(m_draft, spring), client);
}

std::string Workshop::Cut(const Builder& builder, const physics::Blade& blade, const physics::World& world) {
  const std::vector<Vector3d> places = FindPlaces(world);
  for (std::size_t i = m_springs.size(); i-- > 0;) {
    if (m_changes >= kMostChanges) return kBusy;
    const physics::Spring<double>& spring = m_draft.full.springs[i];
    if (!MayChange(builder, m_springs[i])) continue;
    if (!physics::IsCrossed(places[spring.a], places[spring.b], blade)) continue;
    if (std::string error = Take(RemoveSpring(m_draft, i), 0); !error.empty()) return error;
  }
  return "";
}

bool Workshop::MayRemove(const Builder& builder, std::size_t particle) const {
  if (!MayChange(builder, m_particles[particle])) return false;
  for (std::size_t i = 0; i < m_springs.size(); ++i) {
    const physics::Spring<double>& spring = m_draft.full.springs[i];
    if ((spring.a == particle || spring.b == particle) && !MayChange(builder, m_springs[i])) return false;
  }
  return true;
}

std::string Workshop::Take(GraphEdit&& edit, ClientId client) {
  if (!edit.errors.empty()) return Describe(edit.errors);
  ++m_changes;
  const std::size_t particles = edit.blueprint.rest.size();
  const std::size_t springs = edit.blueprint.full.springs.size();
  KeepPlaces(edit.keptParticles);
  Keep(m_particles, edit.keptParticles);
  Keep(m_springs, edit.keptSprings);
  if (particles > m_particles.size()) m_particles.push_back({FindNumber(), client});
  if (springs > m_springs.size()) m_springs.push_back({FindNumber(), client});
  m_draft = std::move(edit.blueprint);
  m_changed = true;
  return "";
}

void Workshop::KeepPlaces(std::span<const std::uint16_t> kept) {
  const std::size_t fromWorld = m_kept.size();
  const auto split = std::ranges::lower_bound(kept, fromWorld) - kept.begin();
  std::vector<std::uint16_t> waiting(kept.begin() + split, kept.end());
  for (std::uint16_t& place : waiting) place = static_cast<std::uint16_t>(place - fromWorld);
  Keep(m_kept, kept.first(static_cast<std::size_t>(split)));
  Keep(m_new, waiting);
}

Workshop::Memory Workshop::Read() const {
  return {.isProtected = m_rules.isProtected,
          .draft = physics::FindParts(m_draft),
          .particles = m_particles,
          .springs = m_springs,
          .kept = m_kept,
          .fresh = m_new,
          .shownParticles = m_shownParticles,
          .shownSprings = m_shownSprings,
          .changed = m_changed,
          .changes = m_changes,
          .sinceUpdate = m_sinceUpdate,
          .lastNumber = m_lastNumber};
}

bool Workshop::Write(const Memory& memory, const physics::World& world) {
  const physics::Blueprint& shown = world.BlueprintOf(world.ReadBody(m_body));
  GraphEdit draft = SetParts(m_original, memory.draft);
  const bool areKept = std::ranges::is_sorted(memory.kept, std::ranges::less_equal()) &&
                       (memory.kept.empty() || memory.kept.back() < shown.rest.size());
  const bool areFresh = std::ranges::all_of(memory.fresh, [](const Vector3d& x) { return x.allFinite(); });
  if (!draft.errors.empty() || !areKept || !areFresh ||
      memory.kept.size() + memory.fresh.size() != draft.blueprint.rest.size() ||
      memory.particles.size() != draft.blueprint.rest.size() ||
      memory.springs.size() != draft.blueprint.full.springs.size() ||
      memory.shownParticles.size() != shown.rest.size() || memory.shownSprings.size() != shown.full.springs.size()) {
    return false;
  }
  m_rules.isProtected = memory.isProtected;
  m_draft = std::move(draft.blueprint);
  m_particles = memory.particles;
  m_springs = memory.springs;
  m_kept = memory.kept;
  m_new = memory.fresh;
  m_shownParticles = memory.shownParticles;
  m_shownSprings = memory.shownSprings;
  m_changed = memory.changed;
  m_changes = memory.changes;
  m_sinceUpdate = memory.sinceUpdate;
  m_lastNumber = memory.lastNumber;
  return true;
}

// Ends, because there are many more numbers than parts.
std::uint16_t Workshop::FindNumber() {
  do {
    ++m_lastNumber;
  } while (m_lastNumber == 0 || Find(m_particles, m_lastNumber) >= 0 || Find(m_springs, m_lastNumber) >= 0);
  return m_lastNumber;
}

std::vector<Vector3d> Workshop::FindPlaces(const physics::World& world) const {
  std::vector<Vector3d> present;
  physics::VisitVertices(world.ReadBody(m_body), [&](std::size_t, const Vector3d& x) { present.push_back(x); });
  std::vector<Vector3d> places;
  for (const std::uint16_t vertex : m_kept) places.push_back(present[vertex]);
  places.insert(places.end(), m_new.begin(), m_new.end());
  return places;
}

bool Workshop::Update(physics::World& world) {
  m_sinceUpdate += world.Settings().tickDuration;
  if (m_sinceUpdate < kUpdateTime) return false;
  m_sinceUpdate = 0;
  m_changes = 0;
  if (!m_changed) return false;
  const std::vector<Vector3d> places = FindPlaces(world);
  if (!world.ReplaceBlueprint(m_body, m_draft, m_kept))
    return false;  // all blueprint slots are in use: try again later
  std::vector<Vector3d> velocities;
  std::visit(
      [&](const auto& state) {
        for (const auto& v : state.velocities) velocities.emplace_back(v.template cast<double>());
      },
      world.ReadBody(m_body).state);
  world.SetMotion(m_body, places, velocities);
  NoteShown();
  return true;
}

}  // namespace wobble::server
