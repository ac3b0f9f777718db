// Changes of a body's topology while the world runs. A blueprint is immutable, so each change makes a new blueprint in
// another slot. Slots that no body uses any more are taken again, the one with the oldest blueprint first.
#include <algorithm>
#include <cassert>
#include <functional>
#include <map>
#include <numeric>
#include <set>

#include "server/physics/methods/stability.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/shapes/tear.h"
#include "server/physics/world_engine.h"

namespace wobble::physics {
namespace {

// Shortest time between two blueprints of a body that goes on tearing, s: each is sent whole to every client.
constexpr double kRebuildTime = 0.25;
constexpr std::size_t kMaxSlots = 255;

constexpr std::uint16_t kGone = 0xFFFF;

using Edge = std::array<std::uint32_t, 2>;

// The new place of each of `count` vertices; kGone for those that are not kept. kept: as for World::ReplaceBlueprint.
std::vector<std::uint16_t> FindPlaces(std::span<const std::uint16_t> kept, std::size_t count) {
  std::vector<std::uint16_t> places(count, kGone);
  for (std::size_t i = 0; i < kept.size(); ++i) places[kept[i]] = static_cast<std::uint16_t>(i);
  return places;
}

std::vector<std::uint16_t> ListNumbers(std::size_t count) {
  std::vector<std::uint16_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), std::uint16_t{0});
  return numbers;
}

// Faces by the new places of their vertices.
std::vector<Face> Renumber(std::vector<Face> faces, std::span<const std::uint16_t> places) {
  for (Face& face : faces) {
    for (std::uint16_t& vertex : face) vertex = places[vertex];
  }
  return faces;
}

Edge MakeEdge(std::uint32_t a, std::uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

// The torn springs, by the new places of their ends, but for springs that lose an end.
std::set<Edge> FindTornEdges(const Blueprint& blueprint, std::span<const std::uint8_t> torn,
                             std::span<const std::uint16_t> places) {
  std::set<Edge> edges;
  for (std::size_t i = 0; i < torn.size(); ++i) {
    const Spring<double>& spring = blueprint.full.springs[i];
    if (torn[i] == 0 || places[spring.a] == kGone || places[spring.b] == kGone) continue;
    edges.insert(MakeEdge(places[spring.a], places[spring.b]));
  }
  return edges;
}

// Marks the blueprint's springs along these edges as torn. Returns whether there are any.
bool MarkTorn(const Blueprint& blueprint, const std::set<Edge>& edges, std::vector<std::uint8_t>& torn) {
  const std::vector<Spring<double>>& springs = blueprint.full.springs;
  const auto isTorn = [&](const Spring<double>& spring) { return edges.contains(MakeEdge(spring.a, spring.b)); };
  if (std::ranges::none_of(springs, isTorn)) return false;
  torn.resize(springs.size(), 0);
  for (std::size_t i = 0; i < springs.size(); ++i) torn[i] = isTorn(springs[i]) ? 1 : 0;
  return true;
}

// The place of each face of `before` in `after`, which has lost some faces and kept the order of the others; kNoFace
// for lost faces.
std::vector<std::uint16_t> MapFaces(std::span<const Face> before, std::span<const Face> after) {
  std::vector<std::uint16_t> map(before.size(), kNoFace);
  for (std::size_t i = 0, next = 0; i < before.size() && next < after.size(); ++i) {
    if (before[i] == after[next]) map[i] = static_cast<std::uint16_t>(next++);
  }
  return map;
}

// Renumbers the faces in contacts of other bodies with this one, and drops contacts with lost faces.
template <class Real>
void RenumberFaces(PairLists<Real>& pairs, BodyId id, std::span<const std::uint16_t> map) {
  VisitPairsOf(id, pairs, [&](BodyPair<Real>& pair) {
    auto& contacts = pair.sides[1 - pair.SideOf(id)];
    std::erase_if(contacts, [&](const BodyContact<Real>& contact) { return map[contact.face] == kNoFace; });
    for (BodyContact<Real>& contact : contacts) contact.face = map[contact.face];
  });
}

// The place of each of the edges `before` in `after`; kGone for lost ones. places: by old vertex.
std::vector<std::uint16_t> MapEdges(std::span<const EdgeEnds> before, std::span<const EdgeEnds> after,
                                    std::span<const std::uint16_t> places) {
  std::map<EdgeEnds, std::uint16_t> found;
  for (const EdgeEnds& ends : after) found.emplace(ends, static_cast<std::uint16_t>(found.size()));
  std::vector<std::uint16_t> map;
  for (const EdgeEnds& ends : before) {
    const auto at = found.find({places[ends[0]], places[ends[1]]});
    map.push_back(at == found.end() ? kGone : at->second);
  }
  return map;
}

// Renumbers one edge of each contact, and drops contacts of lost edges.
template <class Real>
void RenumberEdges(std::uint16_t EdgeContact<Real>::*edge, std::span<const std::uint16_t> map,
                   std::vector<EdgeContact<Real>>& contacts) {
  std::erase_if(contacts, [&](const EdgeContact<Real>& contact) { return map[contact.*edge] == kGone; });
  for (EdgeContact<Real>& contact : contacts) contact.*edge = map[contact.*edge];
}

// Renumbers this body's edges in its contacts with others and with itself. places: by old vertex.
template <class Real>
void RenumberEdges(const World& world, PairLists<Real>& pairs, BodyId id, const Blueprint& before,
                   const Blueprint& after, std::span<const std::uint16_t> places) {
  const auto toSelf = MapEdges(before.selfEdges, after.selfEdges, places);
  VisitPairsOf(id, pairs, [&](BodyPair<Real>& pair) {
    const auto mapToOther = [&] {
      const Blueprint& other = world.BlueprintOf(*world.FindBody(pair.OtherThan(id)));
      return MapEdges(FindMeetingEdges(before, other), FindMeetingEdges(after, other), places);
    };
    const std::vector<std::uint16_t> map = pair.IsSelf() ? toSelf : mapToOther();
    if (pair.first == id) RenumberEdges(&EdgeContact<Real>::first, map, pair.edges);
    if (pair.second == id) RenumberEdges(&EdgeContact<Real>::second, map, pair.edges);
    std::sort(pair.edges.begin(), pair.edges.end(),
              [](const EdgeContact<Real>& a, const EdgeContact<Real>& b) { return IsListedBefore(a, b); });
  });
}

// Renumbers the vertices of the contacts, and drops contacts of lost vertices. places: by old vertex.
template <class Contacts>
void RenumberVertices(Contacts& contacts, std::span<const std::uint16_t> places) {
  std::erase_if(contacts, [&](const auto& contact) { return places[contact.vertex] == kGone; });
  for (auto& contact : contacts) contact.vertex = places[contact.vertex];
}

// Vertices beyond the kept ones come where the rest shape has them beside these.
template <class Real>
void FitState(const Blueprint& blueprint, std::span<const std::uint16_t> kept, State<Real>& state) {
  RenumberVertices(state.contacts, FindPlaces(kept, state.positions.size()));
  Vector3d shift = Vector3d::Zero();
  for (std::size_t i = 0; i < kept.size(); ++i) {
    state.positions[i] = state.positions[kept[i]];
    state.velocities[i] = state.velocities[kept[i]];
    shift += state.positions[i].template cast<double>() - blueprint.rest[i];
  }
  if (!kept.empty()) shift /= static_cast<double>(kept.size());
  state.positions.resize(kept.size());
  for (std::size_t i = kept.size(); i < blueprint.rest.size(); ++i) {
    state.positions.push_back((blueprint.rest[i] + shift).template cast<Real>());
  }
  state.velocities.resize(kept.size());
  state.velocities.resize(blueprint.rest.size(), Vector3<Real>::Zero());
  for (const std::uint16_t vertex : blueprint.full.fixed) state.velocities[vertex].setZero();
  state.torn.assign(blueprint.full.tearStretch > 0 ? blueprint.full.springs.size() : 0, 0);
}

}  // namespace

std::size_t World::FindFreeSlot() const {
  std::vector<bool> isUsed(m_slots.size(), false);
  for (const Body& body : m_bodies) isUsed[body.blueprint] = true;
  std::size_t best = m_slots.size();
  for (std::size_t slot = 0; slot < m_slots.size(); ++slot) {
    if (m_slots[slot].isKept || isUsed[slot]) continue;
    if (best == m_slots.size() || m_slots[slot].revision < m_slots[best].revision) best = slot;
  }
  return best;
}

void World::PutIntoSlot(std::size_t slot, Blueprint blueprint, BlueprintRecipe recipe) {
  if (slot == m_slots.size()) {
    m_blueprints.emplace_back();
    m_slots.emplace_back();
    m_recipes.emplace_back();
  }
  m_blueprints[slot] = std::move(blueprint);
  m_recipes[slot] = std::move(recipe);
  SetIntegrator(m_blueprints[slot], m_blueprints[slot].integrator);  // its pattern must be that of the new springs
  m_slots[slot].revision = ++m_blueprintRevision;
  m_slots[slot].stiffnessBound = FindStiffnessBound(m_blueprints[slot], m_settings.tickDuration);
}

void World::PutOntoSlot(Body& body, std::size_t slot, Blueprint blueprint, BlueprintRecipe recipe,
                        std::span<const std::uint16_t> kept) {
  PutIntoSlot(slot, std::move(blueprint), std::move(recipe));
  body.blueprint = static_cast<std::uint8_t>(slot);
  body.selfRoom = 0;
  WakeUp(body);
  std::visit([&](auto& state) { FitState(m_blueprints[slot], kept, state); }, body.state);
}

bool World::ReplaceBlueprint(BodyId id, Blueprint blueprint, std::span<const std::uint16_t> kept) {
  const std::size_t slot = FindFreeSlot();
  if (slot >= kMaxSlots) return false;
  Body& body = Write(id);
  const Blueprint& before = BlueprintOf(body);
  assert(kept.size() <= blueprint.rest.size() && std::ranges::is_sorted(kept, std::ranges::less_equal()));
  assert(kept.empty() || kept.back() < before.rest.size());
  const auto places = FindPlaces(kept, before.rest.size());
  const auto faces = MapFaces(Renumber(before.full.faces, places), blueprint.full.faces);
  const auto renumber = [&](auto& work) {
    const auto ofVertices = [&](auto& pair) { RenumberVertices(pair.sides[pair.SideOf(id)], places); };
    VisitPairsOf(id, work.pairs, ofVertices);
    RenumberFaces(work.pairs, id, faces);
    RenumberEdges(*this, work.pairs, id, before, blueprint, places);
  };
  std::visit(renumber, m_engine->workspace);
  RenumberForces(id, places);
  const auto torn = std::visit([&](auto& state) { return FindTornEdges(before, state.torn, places); }, body.state);
  WakeNeighboursOf(id);
  BlueprintRecipe recipe{.base = m_recipes[body.blueprint].base, .parts = FindParts(blueprint), .torn = {}};
  PutOntoSlot(body, slot, std::move(blueprint), std::move(recipe), kept);
  const bool isTorn =
      std::visit([&](auto& state) { return MarkTorn(m_blueprints[slot], torn, state.torn); }, body.state);
  if (!isTorn) body.tornTicks = 0;
  return true;
}

void World::RenumberForces(BodyId id, std::span<const std::uint16_t> places) {
  std::erase_if(m_stepForces,
                [&](const StepForce& each) { return each.body == id && places[each.force.vertex] == kGone; });
  for (StepForce& each : m_stepForces) {
    if (each.body == id) each.force.vertex = places[each.force.vertex];
  }
  for (Drive& drive : m_drives) {
    if (drive.body != id) continue;
    std::erase_if(drive.vertices, [&](std::uint16_t vertex) { return places[vertex] == kGone; });
    for (std::uint16_t& vertex : drive.vertices) vertex = places[vertex];
  }
}

std::size_t World::CutSprings(BodyId id, const Blade& blade) {
  assert(std::ranges::all_of(blade, [](const Vector3d& corner) { return corner.allFinite(); }));
  Body& body = Write(id);
  const Blueprint& blueprint = BlueprintOf(body);
  if (blueprint.full.gas > 0) return 0;
  const std::size_t cut = std::visit(
      [&]<class Real>(State<Real>& state) {
        const Blade local{blade[0] - state.origin, blade[1] - state.origin, blade[2] - state.origin};
        std::vector<std::uint8_t> torn = state.torn;
        torn.resize(blueprint.full.springs.size(), 0);
        const std::size_t found = FindCut<Real>(blueprint.Read<Real>(), local, state.positions, torn);
        if (found > 0) state.torn = std::move(torn);
        return found;
      },
      body.state);
  if (cut == 0) return 0;
  if (body.tornTicks == 0) {
    body.tornTicks = 1;
    m_tearing.push_back(id);
  }
  WakeUp(body);
  WakeNeighboursOf(id);
  return cut;
}

void World::RebuildTorn() {
  for (const std::uint32_t place : m_engine->stepped) {
    if (m_bodies[place].tornTicks == 1) m_tearing.push_back(m_bodies[place].id);
  }
  if (m_tearing.empty()) return;
  std::sort(m_tearing.begin(), m_tearing.end());
  for (const BodyId id : m_tearing) {
    Body& body = Write(id);
    if (body.tornTicks * m_settings.tickDuration < kRebuildTime) continue;
    const std::size_t slot = FindFreeSlot();
    if (slot >= kMaxSlots) break;
    const auto& torn = std::visit(
        [](const auto& state) -> const auto& { return state.torn; }, body.state);
    const auto kept = ListNumbers(m_blueprints[body.blueprint].rest.size());
    Blueprint left = MakeTornBlueprint(m_blueprints[body.blueprint], torn);
    const auto map = MapFaces(m_blueprints[body.blueprint].full.faces, left.full.faces);
    const auto renumber = [&](auto& work) {
      RenumberFaces(work.pairs, body.id, map);
      RenumberEdges(*this, work.pairs, body.id, m_blueprints[body.blueprint], left, kept);
    };
    std::visit(renumber, m_engine->workspace);
    BlueprintRecipe recipe = m_recipes[body.blueprint];
    const Blueprint& base = m_blueprints[recipe.base];
    AddTorn(recipe, recipe.parts ? recipe.parts->springs.size() : base.full.springs.size(), torn);
    PutOntoSlot(body, slot, std::move(left), std::move(recipe), kept);
    body.tornTicks = 0;
  }
  std::erase_if(m_tearing, [this](BodyId id) { return Write(id).tornTicks == 0; });
}

}  // namespace wobble::physics
