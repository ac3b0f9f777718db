// What a world works with besides its bodies, for world.cpp and world_step.cpp alone. Kept from tick to tick to save
// allocations; only pairs and what stands here of sleeping bodies carry anything over.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <tuple>
#include <vector>

#include "server/physics/broad_phase.h"
#include "server/physics/group_step.h"
#include "server/physics/pack_step.h"
#include "server/physics/parallel.h"
#include "server/physics/roster.h"
#include "server/physics/sleep.h"
#include "server/physics/world.h"

namespace wobble::physics {

// Two bodies near one another, and what lives on of their contacts from tick to tick. first < second.
template <class Real>
struct BodyPair {
  BodyId first = 0;
  BodyId second = 0;
  IndexPair places{};                                   // of the two in the world
  std::array<std::vector<BodyContact<Real>>, 2> sides;  // as in Encounter
  bool met = false;                                     // its contacts are this tick's

  [[nodiscard]] bool Has(BodyId body) const { return first == body || second == body; }
};

template <class Real>
bool ComesBefore(const BodyPair<Real>& a, const BodyPair<Real>& b) {
  return a.first != b.first ? a.first < b.first : a.second < b.second;
}

struct Outcome {
  GroupOutcome steps;
  Health health = Health::kGood;
  bool reset = false;
  std::size_t torn = 0;  // springs
};

template <class Real>
struct Scratch {
  GroupScratch<Real> group;
  std::vector<Contact<Real>> contacts;
  std::vector<BodyContact<Real>> bodyContacts;
  std::vector<Member<Real>*> members;
  PackScratch<Real> pack;
};

// A body that touches no other and is stepped beside others of its kind.
struct LoneBody {
  std::uint32_t blueprint = 0;
  int substeps = 0;  // of its first try
  std::uint32_t body = 0;

  auto operator<=>(const LoneBody&) const = default;
};

template <class Real>
struct Workspace {
  std::vector<BodyPair<Real>> pairs;  // ascending; at the end of a tick those of whom both are awake
  std::vector<BodyPair<Real>> pairsBefore;
  std::vector<BodyPair<Real>> restingPairs;                // of whom both sleep, or did at wake `wakesSeen`
  std::uint64_t wakesSeen = 0;                             // of the roster's
  std::vector<std::vector<BodyContact<Real>>> spareLists;  // of pairs that have parted
  std::vector<IndexPair> pairIndices;                      // the places of `pairs`
  // By place in the world. What is looked at of one that sleeps, others have seen to (PairSearch).
  std::vector<Member<Real>> members;
  std::vector<Box> boxes;
  std::vector<Box> awakeBoxes;
  std::vector<IndexPair> overlaps;
  BroadPhase broadPhase;
  std::vector<Vector3d> safePlaces;
  std::vector<std::uint32_t> woken;
  std::vector<std::uint32_t> falling;  // asleep
  Groups groups;
  std::vector<std::uint32_t> placeOf;       // of each body in its group
  std::vector<Encounter<Real>> encounters;  // those of group g from encounterBegins[g] up to encounterBegins[g + 1]
  std::vector<std::size_t> encounterBegins;
  std::vector<std::uint32_t> smallGroups;  // stepped side by side, each by one thread
  std::vector<std::uint32_t> largeGroups;  // one after the other, each by all
  std::vector<LoneBody> loneBodies;        // in packs, the p-th from packBegins[p] up to packBegins[p + 1]
  std::vector<std::size_t> packBegins;
  std::vector<Outcome> outcomes;
  tbb::enumerable_thread_specific<Scratch<Real>> scratch;

  // Of the body that was at `index` and is gone, with its pairs.
  void Forget(std::size_t index) {
    for (BodyPair<Real>& pair : restingPairs) {
      for (std::uint32_t& place : pair.places) place -= place > index ? 1 : 0;
    }
    if (index >= members.size()) return;
    members.erase(members.begin() + static_cast<std::ptrdiff_t>(index));
    boxes.erase(boxes.begin() + static_cast<std::ptrdiff_t>(index));
  }
};

struct World::Engine {
  explicit Engine(int threadCount) : threads(threadCount) {}

  void Add(const Blueprint& blueprint) {
    roster.Add();
    vertices += blueprint.rest.size();
  }
  void Forget(std::size_t index, const Body& body, const Blueprint& blueprint) {
    roster.Remove(static_cast<std::uint32_t>(index), body.asleep);
    for (std::uint32_t& place : stepped) place -= place > index ? 1 : 0;
    vertices -= blueprint.rest.size();
    std::get<0>(workspaces).Forget(index);
    std::get<1>(workspaces).Forget(index);
  }

  Threads threads;
  Roster roster;
  std::vector<std::uint32_t> stepped;                          // by the last tick: places, ascending
  std::size_t vertices = 0;                                    // of all bodies
  std::tuple<Workspace<float>, Workspace<double>> workspaces;  // the world's precision uses one
};

}  // namespace wobble::physics
