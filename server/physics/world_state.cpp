// What a world is stored as, and how it goes on from that.
//
// Lists that only save allocations start empty again. A sleeping body's member, which searches read, is made of what
// SleeperState keeps; PairSearch sets its pointers where it reads them.
#include "server/physics/world_state.h"

#include <algorithm>
#include <optional>

#include "server/physics/world_engine.h"

namespace wobble::physics {
namespace {

template <class Real>
std::vector<SleeperState> CaptureSleepers(std::span<const Body> bodies, const Workspace<Real>& work) {
  std::vector<SleeperState> sleepers;
  for (std::size_t place = 0; place < bodies.size(); ++place) {
    if (!bodies[place].asleep) continue;
    const Survey<Real>& survey = work.members[place].survey;
    sleepers.push_back({.box = work.boxes[place],
                        .low = survey.bounds.low.template cast<double>(),
                        .high = survey.bounds.high.template cast<double>(),
                        .speed = double{survey.bounds.speed},
                        .agitation = double{survey.agitation}});
  }
  return sleepers;
}

template <class Real>
void RestoreSleepers(std::span<const Body> bodies, std::span<const SleeperState> sleepers, Roster& roster,
                     Workspace<Real>& work) {
  std::vector<std::uint32_t> places;
  for (std::size_t place = 0; place < bodies.size(); ++place) {
    if (!bodies[place].asleep) continue;
    const SleeperState& sleeper = sleepers[places.size()];
    Survey<Real>& survey = work.members[place].survey;
    survey.bounds = {.low = sleeper.low.template cast<Real>(),
                     .high = sleeper.high.template cast<Real>(),
                     .speed = static_cast<Real>(sleeper.speed)};
    survey.agitation = static_cast<Real>(sleeper.agitation);
    work.boxes[place] = sleeper.box;
    places.push_back(static_cast<std::uint32_t>(place));
  }
  roster.LetSleep(places, work.boxes);
}

// Gives each pair the places of its bodies.
template <class Real>
void FillPlaces(std::span<const Body> bodies, std::vector<BodyPair<Real>>& pairs) {
  const auto find = [&](BodyId id) {
    const auto found = std::ranges::lower_bound(bodies, id, {}, &Body::id);
    return static_cast<std::uint32_t>(found - bodies.begin());
  };
  for (BodyPair<Real>& pair : pairs) pair.places = {find(pair.first), find(pair.second)};
}

}  // namespace

WorldState World::Capture() const {
  WorldState state{.tick = m_tick,
                   .gravity = m_settings.gravity,
                   .stiffnessFactor = m_settings.stiffnessFactor,
                   .nextId = m_nextId,
                   .slots = {},
                   .bodies = m_bodies,
                   .sleepers = {},
                   .tearing = m_tearing,
                   .drives = m_drives,
                   .stepForces = m_stepForces,
                   .pairs = {}};
  for (std::size_t slot = 0; slot < m_slots.size(); ++slot) {
    if (m_slots[slot].isKept) continue;
    const auto isOlder = [&](const BlueprintSlot& other) {
      return !other.isKept && other.revision < m_slots[slot].revision;
    };
    const auto older = static_cast<std::uint32_t>(std::ranges::count_if(m_slots, isOlder));
    state.slots.push_back({older + 1, m_recipes[slot]});
  }
  std::visit(
      [&]<class Real>(const Workspace<Real>& work) {
        state.sleepers = CaptureSleepers(m_bodies, work);
        state.pairs = PairsState<Real>{.awake = work.pairs.awake, .resting = work.pairs.resting};
      },
      m_engine->workspace);
  return state;
}

std::string World::Restore(const WorldState& state) {
  const auto kept = static_cast<std::size_t>(std::ranges::count(m_slots, true, &BlueprintSlot::isKept));
  std::vector<Blueprint> made;
  std::vector<const Blueprint*> blueprints;
  for (std::size_t slot = 0; slot < kept; ++slot) blueprints.push_back(&m_blueprints[slot]);
  if (kept + state.slots.size() > 255) return "slots " + std::to_string(state.slots.size()) + ": must be fewer";
  made.reserve(state.slots.size());
  for (const SlotState& slot : state.slots) {
    std::string error = "base " + std::to_string(slot.recipe.base) + ": must be one of the scene's blueprints";
    std::optional<Blueprint> blueprint;
    if (slot.recipe.base < kept) blueprint = MakeFromRecipe(m_blueprints[slot.recipe.base], slot.recipe, error);
    if (!blueprint) return "blueprint " + std::to_string(kept + made.size()) + ": " + error;
    made.push_back(std::move(*blueprint));
    blueprints.push_back(&made.back());
  }
  std::string error = FindUnsound(state, *this, blueprints);
  if (!error.empty()) return error;

  m_blueprints.resize(kept);
  m_slots.resize(kept);
  m_recipes.resize(kept);
  // Revisions grow, so that whoever keeps copies notices.
  const std::uint64_t before = m_blueprintRevision;
  for (std::size_t i = 0; i < made.size(); ++i) {
    PutIntoSlot(kept + i, std::move(made[i]), state.slots[i].recipe);
    m_slots[kept + i].revision = before + state.slots[i].age;
    m_blueprintRevision = std::max(m_blueprintRevision, m_slots[kept + i].revision);
  }
  ++m_blueprintRevision;
  ++m_removals;
  ++m_restores;
  m_tick = state.tick;
  m_settings.gravity = m_engine->gravity = state.gravity;
  m_settings.stiffnessFactor = state.stiffnessFactor;
  m_nextId = state.nextId;
  m_bodies = state.bodies;
  m_tearing = state.tearing;
  m_drives = state.drives;
  m_stepForces = state.stepForces;
  m_engine->stepped.clear();
  m_engine->roster = {};
  for (std::size_t i = 0; i < m_bodies.size(); ++i) m_engine->roster.Add();
  std::visit(
      [&]<class Real>(Workspace<Real>& work) {
        work.members.clear();
        work.Resize(m_bodies.size());
        work.pairs = {};
        const auto& pairs = std::get<PairsState<Real>>(state.pairs);
        work.pairs.awake = pairs.awake;
        work.pairs.resting = pairs.resting;
        FillPlaces(m_bodies, work.pairs.awake);
        FillPlaces(m_bodies, work.pairs.resting);
        // Pairs of bodies that were woken since the last tick wait among the resting ones.
        work.pairs.wakesSeen = m_engine->roster.CountWakes() - 1;
        RestoreSleepers<Real>(m_bodies, state.sleepers, m_engine->roster, work);
      },
      m_engine->workspace);
  return {};
}

}  // namespace wobble::physics
