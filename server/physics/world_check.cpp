// What the engine trusts of its own state, looked at in a state that comes from a file.
#include <algorithm>
#include <cmath>
#include <functional>

#include "server/physics/skins/skin_gap.h"
#include "server/physics/world_state.h"

namespace wobble::physics {
namespace {

constexpr double kFarthest = 1e6;    // of an origin or a box from the world's origin, m
constexpr double kMostFactor = 1e3;  // of gas and stiffness
constexpr int kMostTicks = 1 << 30;

template <class Value>
std::string Unless(bool holds, const char* field, Value value, const char* range) {
  return holds ? std::string() : std::string(field) + " " + std::to_string(value) + ": must be " + range;
}

// The first of these texts that is not empty.
template <class... Texts>
std::string FindFirst(Texts... texts) {
  std::string first;
  ((first = first.empty() ? std::string(texts) : first), ...);
  return first;
}

bool IsNear(const Vector3d& x) { return x.allFinite() && x.cwiseAbs().maxCoeff() <= kFarthest; }
bool IsFactor(double factor) { return factor > 0 && factor <= kMostFactor; }
bool IsCount(int ticks) { return ticks >= 0 && ticks <= kMostTicks; }

// A state under inspection.
struct Inspection {
  const WorldState& state;
  std::span<const Blueprint* const> blueprints;
  std::size_t obstacles = 0;

  [[nodiscard]] const Body* Find(BodyId id) const {
    const auto found = std::ranges::lower_bound(state.bodies, id, {}, &Body::id);
    return found != state.bodies.end() && found->id == id ? &*found : nullptr;
  }
  [[nodiscard]] const Blueprint& BlueprintOf(const Body& body) const { return *blueprints[body.blueprint]; }
  [[nodiscard]] bool HasVertex(const Body& body, std::size_t vertex) const {
    return vertex < BlueprintOf(body).rest.size();
  }
};

template <class Real>
std::string CheckContacts(const Inspection& subject, const Body& body, const std::vector<Contact<Real>>& contacts) {
  const auto isKnown = [&](const Contact<Real>& contact) {
    return contact.surface < subject.obstacles && subject.HasVertex(body, contact.vertex);
  };
  const auto comesBefore = [](const Contact<Real>& a, const Contact<Real>& b) {
    return a.surface != b.surface ? a.surface < b.surface : a.vertex < b.vertex;
  };
  const auto isInOrder = [&](const Contact<Real>& a, const Contact<Real>& b) { return !comesBefore(a, b); };
  return FindFirst(Unless(std::ranges::all_of(contacts, isKnown), "contacts", contacts.size(),
                          "of vertices and obstacles that there are"),
                   Unless(std::ranges::adjacent_find(contacts, isInOrder) == contacts.end(), "contacts",
                          contacts.size(), "in order, each once"));
}

template <class Real>
std::string CheckState(const Inspection& subject, const Body& body, const State<Real>& state) {
  const Blueprint& blueprint = subject.BlueprintOf(body);
  const std::size_t vertices = blueprint.rest.size();
  return FindFirst(Unless(IsNear(state.origin), "origin", state.origin.norm(), "finite, within 1e6 m"),
                   Unless(state.positions.size() == vertices, "positions", state.positions.size(), "one a vertex"),
                   Unless(state.velocities.size() == vertices, "velocities", state.velocities.size(), "one a vertex"),
                   Unless(state.torn.empty() || state.torn.size() == blueprint.full.springs.size(), "torn",
                          state.torn.size(), "none or one a spring"),
                   CheckContacts(subject, body, state.contacts));
}

std::string CheckBody(const Inspection& subject, std::size_t precision, const Body& body) {
  if (body.blueprint >= subject.blueprints.size())
    return Unless(false, "blueprint", body.blueprint, "one of the world's");
  if (body.state.index() != precision) return Unless(false, "precision", body.state.index(), "the world's");
  const auto& [id, blueprint, state, control, limits, jumpHeld, touchesBody, gasFactor, stiffnessFactor, steps,
               selfRoom, selfAgitation, asleep, quietTicks, invertedTicks, lostTicks, tornTicks] = body;
  const bool areLimits = std::isfinite(limits.acceleration) && std::isfinite(limits.speed) &&
                         std::isfinite(limits.jumpSpeed) && IsFactor(limits.puffFactor) &&
                         IsFactor(limits.stiffenFactor);
  const StepHistory::Memory& memory = steps.Read();
  return FindFirst(
      Unless(control.IsPossible(), "move", std::hypot(control.moveX, control.moveY), "at most 1"),
      Unless(areLimits, "limits", limits.speed, "finite, with factors above 0"),
      Unless(IsFactor(gasFactor), "gasFactor", gasFactor, "above 0, up to 1000"),
      Unless(IsFactor(stiffnessFactor), "stiffnessFactor", stiffnessFactor, "above 0, up to 1000"),
      Unless(memory.next < StepHistory::kTicks, "steps.next", int{memory.next}, "below 6"),
      Unless(memory.substeps >= 1 && memory.substeps <= kMostTicks, "steps.substeps", memory.substeps, "at least 1"),
      Unless(IsCount(memory.ticksBelow), "steps.ticksBelow", memory.ticksBelow, "0 or more"),
      Unless(!std::isnan(selfRoom) && !std::isnan(selfAgitation), "selfRoom", selfRoom, "a number"),
      Unless(IsCount(quietTicks), "quietTicks", quietTicks, "0 or more"),
      Unless(IsCount(invertedTicks), "invertedTicks", invertedTicks, "0 or more"),
      Unless(IsCount(lostTicks), "lostTicks", lostTicks, "0 or more"),
      Unless(IsCount(tornTicks), "tornTicks", tornTicks, "0 or more"),
      std::visit([&](const auto& each) { return CheckState(subject, body, each); }, state));
}

std::string CheckSleeper(const SleeperState& sleeper) {
  const bool isFinite = IsNear(sleeper.box.low) && IsNear(sleeper.box.high) && sleeper.low.allFinite() &&
                        sleeper.high.allFinite() && std::isfinite(sleeper.speed) && std::isfinite(sleeper.agitation);
  return Unless(isFinite, "sleeper", sleeper.speed, "finite, within 1e6 m");
}

std::string CheckDrive(const Inspection& subject, const Drive& drive) {
  const Body* body = subject.Find(drive.body);
  const bool areVertices = std::ranges::all_of(
      drive.vertices, [&](std::uint16_t vertex) { return body != nullptr && subject.HasVertex(*body, vertex); });
  const bool isTimed = drive.period > 0 && drive.begin < drive.end && std::isfinite(drive.period);
  return FindFirst(Unless(drive.body == 0 || body != nullptr, "drive.body", drive.body, "0 or a body of the world"),
                   Unless(areVertices, "drive.vertices", drive.vertices.size(), "vertices of its body"),
                   Unless(drive.force.allFinite() && drive.wind.allFinite() && IsFactor(drive.gasFactor), "drive.force",
                          drive.force.norm(), "finite"),
                   Unless(isTimed, "drive.period", drive.period, "above 0, with begin before end"));
}

std::string CheckForce(const Inspection& subject, const StepForce& each) {
  const Body* body = subject.Find(each.body);
  return FindFirst(Unless(body != nullptr, "force.body", each.body, "a body of the world"),
                   Unless(body != nullptr && subject.HasVertex(*body, each.force.vertex), "force.vertex",
                          each.force.vertex, "a vertex of its body"),
                   Unless(each.force.force.allFinite(), "force.force", each.force.force.norm(), "finite"));
}

// vertices: the body whose vertices touch faces of the other.
template <class Real>
std::string CheckSide(const Blueprint& vertices, const Blueprint& faces, const std::vector<BodyContact<Real>>& side) {
  const auto isKnown = [&](const BodyContact<Real>& contact) {
    return contact.vertex < vertices.rest.size() && contact.face < faces.full.faces.size() &&
           contact.phase <= ContactPhase::kAside && contact.side <= SkinSide::kBack;
  };
  const auto isInOrder = [](const auto& a, const auto& b) { return a.vertex >= b.vertex; };
  return FindFirst(Unless(std::ranges::all_of(side, isKnown), "pair.sides", side.size(), "of vertices and faces"),
                   Unless(std::ranges::adjacent_find(side, isInOrder) == side.end(), "pair.sides", side.size(),
                          "in the order of vertices, each once"));
}

template <class Real>
std::string CheckEdges(std::size_t first, std::size_t second, const std::vector<EdgeContact<Real>>& edges) {
  const auto isKnown = [&](const EdgeContact<Real>& contact) {
    return contact.first < first && contact.second < second && contact.phase <= EdgePhase::kTurned;
  };
  const auto isInOrder = [](const auto& a, const auto& b) { return !IsListedBefore(a, b); };
  return FindFirst(Unless(std::ranges::all_of(edges, isKnown), "pair.edges", edges.size(), "of edges that there are"),
                   Unless(std::ranges::adjacent_find(edges, isInOrder) == edges.end(), "pair.edges", edges.size(),
                          "in order, each once"));
}

template <class Real>
std::string CheckPair(const Inspection& subject, const BodyPair<Real>& pair) {
  const Body* first = subject.Find(pair.first);
  const Body* second = subject.Find(pair.second);
  if (first == nullptr || second == nullptr || pair.first > pair.second)
    return Unless(false, "pair.second", pair.second, "a body of the world, as the first, which is not behind it");
  const Blueprint& ofFirst = subject.BlueprintOf(*first);
  const Blueprint& ofSecond = subject.BlueprintOf(*second);
  const std::size_t edges = pair.IsSelf() ? ofFirst.selfEdges.size() : FindMeetingEdges(ofFirst, ofSecond).size();
  const std::size_t secondEdges = pair.IsSelf() ? edges : FindMeetingEdges(ofSecond, ofFirst).size();
  const bool hasSides = !pair.sides[0].empty() || !pair.sides[1].empty();
  const bool isCore = std::isfinite(pair.core.stiffness) && pair.core.stiffness >= 0;
  const bool isGap = pair.gap >= 0 && pair.gap <= kLargestGap;
  const bool isTangle = pair.tangle.ticks >= 0 && pair.tangle.ticks <= kMostTangleTicks && pair.tangle.untilLook >= 0 &&
                        pair.tangle.untilLook <= kMostTicksUntilLook;
  return FindFirst(Unless(isCore, "pair.core", pair.core.stiffness, "finite, 0 or more"),
                   Unless(isGap, "pair.gap", pair.gap, "0 to 0.01 m"),
                   Unless(isTangle, "pair.tangle.ticks", pair.tangle.ticks, "0 or more, and looked at within 29 ticks"),
                   Unless(!pair.IsSelf() || !hasSides, "pair.sides", 1, "empty for a body with itself"),
                   CheckSide(ofFirst, ofSecond, pair.sides[0]), CheckSide(ofSecond, ofFirst, pair.sides[1]),
                   CheckEdges(edges, secondEdges, pair.edges));
}

template <class Real>
std::string CheckPairs(const Inspection& subject, const PairsState<Real>& pairs) {
  const auto isInOrder = [](const auto& a, const auto& b) { return !ComesBefore(a, b); };
  std::string error = Unless(std::ranges::adjacent_find(pairs.awake, isInOrder) == pairs.awake.end(), "pairs",
                             pairs.awake.size(), "in order, each once");
  for (const auto* list : {&pairs.awake, &pairs.resting}) {
    for (const BodyPair<Real>& pair : *list) {
      if (!error.empty()) return error;
      error = CheckPair(subject, pair);
    }
  }
  return error;
}

std::string CheckWhole(const WorldState& state, std::size_t precision) {
  const auto isInOrder = [](const auto& a, const auto& b) { return a.id >= b.id; };
  const auto asleep = static_cast<std::size_t>(std::ranges::count(state.bodies, true, &Body::asleep));
  const bool areNumbered =
      state.bodies.empty() || (state.bodies.front().id > 0 && state.bodies.back().id < state.nextId);
  return FindFirst(
      Unless(state.gravity.allFinite(), "gravity", state.gravity.norm(), "finite"),
      Unless(state.stiffnessFactor >= kLeastStiffnessFactor && state.stiffnessFactor <= kMostStiffnessFactor,
             "stiffnessFactor", state.stiffnessFactor, "0.25 to 4"),
      Unless(areNumbered && std::ranges::adjacent_find(state.bodies, isInOrder) == state.bodies.end(), "nextId",
             state.nextId, "above the bodies' numbers, which ascend from 1"),
      Unless(state.sleepers.size() == asleep, "sleepers", state.sleepers.size(), "one a body asleep"),
      Unless(state.pairs.index() == precision, "precision", state.pairs.index(), "the world's"),
      Unless(std::ranges::is_sorted(state.tearing, std::ranges::less_equal()), "tearing", state.tearing.size(),
             "in order, each once"),
      Unless(std::ranges::is_sorted(state.stepForces, {}, &StepForce::body), "forces", state.stepForces.size(),
             "in the order of bodies"));
}

}  // namespace

std::string FindUnsound(const WorldState& state, const World& world, std::span<const Blueprint* const> blueprints) {
  const Inspection subject{state, blueprints, world.Obstacles().size()};
  const std::size_t precision = world.Settings().precision == Precision::kSingle ? 0 : 1;
  std::string error = CheckWhole(state, precision);
  for (const Body& body : state.bodies) {
    if (!error.empty()) return error;
    error = CheckBody(subject, precision, body);
    if (!error.empty()) error = "body " + std::to_string(body.id) + ": " + error;
  }
  const auto check = [&error](const auto& list, const auto& find) {
    for (auto each = list.begin(); error.empty() && each != list.end(); ++each) error = find(*each);
  };
  check(state.sleepers, CheckSleeper);
  check(state.drives, [&](const Drive& drive) { return CheckDrive(subject, drive); });
  check(state.stepForces, [&](const StepForce& force) { return CheckForce(subject, force); });
  check(state.tearing, [&](BodyId id) { return Unless(subject.Find(id) != nullptr, "tearing", id, "a body"); });
  if (!error.empty()) return error;
  return std::visit([&](const auto& pairs) { return CheckPairs(subject, pairs); }, state.pairs);
}

}  // namespace wobble::physics
