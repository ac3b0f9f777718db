// What a world works with besides its bodies, for world.cpp and world_step.cpp alone. Kept from tick to tick to save
// allocations; only pairs and what stands here of sleeping bodies carry anything over.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <tuple>
#include <vector>

#include "server/physics/contact/body_contact_search.h"
#include "server/physics/contact/broad_phase.h"
#include "server/physics/model/parallel.h"
#include "server/physics/roster.h"
#include "server/physics/step/batch_step.h"
#include "server/physics/step/sleep.h"
#include "server/physics/world.h"

namespace wobble::physics {

// Two bodies near one another, and what lives on of their contacts from tick to tick. first < second.
template <class Real>
struct BodyPair {
  BodyId first = 0;
  BodyId second = 0;
  IndexPair places{};                                   // of the two in the world
  std::array<std::vector<BodyContact<Real>>, 2> sides;  // as in ContactPair
  bool met = false;                                     // its contacts are this tick's

  [[nodiscard]] bool Has(BodyId body) const { return first == body || second == body; }
  // At the end of the last step that it was in.
  [[nodiscard]] bool IsTouching() const {
    const auto touches = [](const BodyContact<Real>& contact) { return contact.phase == ContactPhase::kTouching; };
    return std::any_of(sides[0].begin(), sides[0].end(), touches) ||
           std::any_of(sides[1].begin(), sides[1].end(), touches);
  }
};

template <class Real>
bool ComesBefore(const BodyPair<Real>& a, const BodyPair<Real>& b) {
  return a.first != b.first ? a.first < b.first : a.second < b.second;
}

struct Outcome {
  IslandOutcome steps;
  Health health = Health::kGood;
  bool reset = false;
  std::size_t torn = 0;  // springs
};

template <class Real>
struct Scratch {
  std::vector<Contact<Real>> contacts;
  ContactSearchScratch<Real> search;
  // Of a batch:
  std::vector<Member<Real>*> members;
  std::vector<ContactPair<Real>> contactPairs;
  std::vector<Island> islands;
  std::vector<IslandOutcome> outcomes;
  BatchScratch<Real> batch;
  std::vector<VertexLoad> loads;
  std::vector<std::size_t> begins;

  // For so many bodies with so many vertices in all; the batch makes its own room.
  void Reserve(std::size_t allVertices, std::size_t bodies) {
    members.reserve(bodies);
    contactPairs.reserve(bodies);
    islands.reserve(bodies);
    outcomes.reserve(bodies);
    loads.reserve(allVertices);
    begins.reserve(bodies + 1);
  }
};

// Bodies that are awake and hang together by contacts. Ordered so that those which are stepped in one batch are side by
// side.
struct AwakeIsland {
  enum class Way : std::uint8_t { kPlain, kAlone, kTogether };

  bool isLarge = false;         // stepped by all threads, one after the other
  Way way = Way::kPlain;        // alone or together: in lanes
  std::uint32_t blueprint = 0;  // of a body that is alone
  int substeps = 0;             // of the first try
  std::uint32_t island = 0;     // in Workspace::islands
  std::size_t vertices = 0;     // of all its bodies

  auto operator<=>(const AwakeIsland&) const = default;
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
  std::vector<SkinPoints<Real>> surfaces;    // of bodies that have one, as the tick found them
  std::vector<std::uint8_t> hasSurface;      // not 0: this body does
  std::vector<std::uint32_t> surfaceBodies;  // that have just come near somebody
  std::vector<Box> boxes;
  std::vector<Box> awakeBoxes;
  std::vector<IndexPair> overlaps;
  BroadPhase broadPhase;
  std::vector<std::uint32_t> woken;
  std::vector<std::uint32_t> falling;  // asleep
  Islands islands;
  std::vector<std::uint32_t> placeOf;  // of each body in its island
  std::vector<ContactPair<Real>>
      contactPairs;  // those of island g from contactPairBegins[g] up to contactPairBegins[g + 1]
  std::vector<std::size_t> contactPairBegins;
  std::vector<AwakeIsland> awakeIslands;  // the b-th batch from batchBegins[b] up to batchBegins[b + 1]
  std::vector<std::size_t> batchBegins;
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

  void Forget(std::size_t index, const Body& body) {
    roster.Remove(static_cast<std::uint32_t>(index), body.asleep);
    for (std::uint32_t& place : stepped) place -= place > index ? 1 : 0;
    std::get<0>(workspaces).Forget(index);
    std::get<1>(workspaces).Forget(index);
  }

  // For so many on the body at `index`.
  void ReservePushes(std::size_t index, std::size_t count) {
    const auto reserve = [&](auto& workspace) {
      if (index < workspace.members.size()) workspace.members[index].pushes.reserve(count);
    };
    reserve(std::get<0>(workspaces));
    reserve(std::get<1>(workspaces));
  }

  Threads threads;
  Roster roster;
  std::vector<std::uint32_t> stepped;                          // by the last tick: places, ascending
  Vector3d gravity = Vector3d::Zero();                         // of the last tick, m/s²
  std::tuple<Workspace<float>, Workspace<double>> workspaces;  // the world's precision uses one
};

}  // namespace wobble::physics
