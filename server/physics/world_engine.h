// What a world works with besides its bodies: lists that are kept from tick to tick. Most are kept only to save
// allocations. The pairs of bodies and what is stored of sleeping bodies carry state from one tick to the next.
//
// For world*.cpp, pair_search and inspect.cpp alone.
#pragma once

#include <tbb/enumerable_thread_specific.h>

#include <algorithm>
#include <variant>
#include <vector>

#include "server/physics/body_pair.h"
#include "server/physics/contact/broad_phase.h"
#include "server/physics/model/parallel.h"
#include "server/physics/packs/batch_step.h"
#include "server/physics/roster.h"
#include "server/physics/skins/body_contact_search.h"
#include "server/physics/step/sleep.h"
#include "server/physics/world.h"

namespace wobble::physics {

// The pairs of a world and the lists that PairSearch finds them with.
template <class Real>
struct PairLists {
  std::vector<BodyPair<Real>> awake;                       // ascending; between ticks, pairs of two awake bodies
  std::vector<BodyPair<Real>> before;                      // of the last tick, as far as they are not `awake` again
  std::vector<BodyPair<Real>> resting;                     // of two sleeping bodies, up to wake `wakesSeen`
  std::uint64_t wakesSeen = 0;                             // of Roster::CountWakes
  std::vector<std::vector<BodyContact<Real>>> spareLists;  // contact lists of pairs that have separated
  std::vector<std::vector<EdgeContact<Real>>> spareEdgeLists;
  std::vector<IndexPair> places;          // of the pairs in `awake`
  std::vector<SkinPoints<Real>> skins;    // by place; as the tick began, of the bodies that hasSkin names
  std::vector<std::uint8_t> hasSkin;      // by place; not 0: `skins` is up to date
  std::vector<std::uint32_t> skinBodies;  // places of bodies whose skin is read next
  std::vector<Box> awakeBoxes;            // of Roster::FindAwake, in its order
  std::vector<IndexPair> overlaps;
  BroadPhase broadPhase;
  std::vector<std::uint32_t> woken;  // places of the bodies that the last PairSearch::WakeTouched woke
};

// visit(pair) for every pair of the body, awake or resting.
template <class Lists, class Visit>
void VisitPairsOf(BodyId body, Lists& lists, const Visit& visit) {
  for (auto* pairs : {&lists.awake, &lists.resting}) {
    for (auto& pair : *pairs) {
      if (pair.Has(body)) visit(pair);
    }
  }
}

// An island of awake bodies. The order puts islands that are stepped in one batch side by side, and the islands that
// all threads step together last.
struct AwakeIsland {
  enum class Way : std::uint8_t {
    kPlain,     // by StepIsland, in plain code
    kAlone,     // one body, in the lanes of a pack
    kTogether,  // bodies that are near others or themselves, in lanes, stage by stage
  };

  bool isLarge = false;  // stepped by all threads, after one another; other islands are stepped by one thread each
  Way way = Way::kPlain;
  std::uint32_t blueprint = 0;  // kAlone: the body's; else 0
  int substeps = 0;             // of the first try
  std::uint32_t island = 0;     // its number in IslandLists::islands
  std::size_t vertices = 0;     // of all its bodies

  auto operator<=>(const AwakeIsland&) const = default;
};

// The islands of a tick and the batches that they are stepped in.
template <class Real>
struct IslandLists {
  Islands islands;
  std::vector<std::uint32_t> memberOf;          // by place of a body: its number in its island
  std::vector<ContactPair<Real>> contactPairs;  // by island
  std::vector<std::size_t> contactPairBegins;   // island i has those from [i] up to [i + 1]
  std::vector<AwakeIsland> awake;               // in the order in which they are batched
  std::vector<std::size_t> batchBegins;         // batch b has the islands of `awake` from [b] up to [b + 1]
  std::vector<std::size_t> batchOrder;          // in which they are stepped: those with most work first
  std::vector<std::size_t> batchWork;           // by batch: vertices times substeps
  std::size_t mostVertices = 0;                 // of one awake body
  std::size_t allVertices = 0;                  // of all awake bodies

  [[nodiscard]] std::span<const ContactPair<Real>> ContactPairsOf(std::uint32_t island) const {
    const std::size_t begin = contactPairBegins[island];
    return std::span(contactPairs).subspan(begin, contactPairBegins[island + 1U] - begin);
  }
  [[nodiscard]] std::size_t CountBatches() const { return batchBegins.size() - 1; }
  [[nodiscard]] std::span<const AwakeIsland> Batch(std::size_t batch) const {
    return std::span(awake).subspan(batchBegins[batch], batchBegins[batch + 1] - batchBegins[batch]);
  }
  // Fills batchOrder with the first `count` batches.
  void SortByWork(std::size_t count) {
    batchOrder.resize(count);
    batchWork.assign(count, 0);
    for (std::size_t batch = 0; batch < count; ++batch) {
      batchOrder[batch] = batch;
      for (const AwakeIsland& each : Batch(batch)) {
        batchWork[batch] += each.vertices * static_cast<std::size_t>(each.substeps);
      }
    }
    std::sort(batchOrder.begin(), batchOrder.end(), [this](std::size_t a, std::size_t b) {
      return batchWork[a] != batchWork[b] ? batchWork[a] > batchWork[b] : a < b;
    });
  }
};

// What a tick did to one body.
struct Outcome {
  IslandOutcome steps;
  Health health = Health::kGood;
  bool inverted = false;  // inside out at the end
  bool reset = false;
  std::size_t torn = 0;  // springs
};

// Scratch of one thread.
template <class Real>
struct Scratch {
  PrepareScratch<Real> prepare;
  ContactSearchScratch<Real> search;
  EdgeSearchScratch<Real> edgeSearch;
  std::vector<std::uint16_t> firstBehind;  // vertices of the first and second body of a pair, by IsBehind
  std::vector<std::uint16_t> secondBehind;
  SelfSearchScratch<Real> selfSearch;
  UntanglingScratch untangling;
  // The batch that the thread steps:
  std::vector<Member<Real>*> members;
  std::vector<ContactPair<Real>> contactPairs;
  std::vector<Island> islands;
  std::vector<IslandOutcome> outcomes;
  BatchScratch<Real> batch;
  std::vector<VertexLoad> loads;
  std::vector<std::size_t> begins;

  // Room for `bodies` bodies with allVertices vertices in all, but for `batch`, which makes its own.
  void Reserve(std::size_t allVertices, std::size_t bodies) {
    members.reserve(bodies);
    contactPairs.reserve(bodies);
    islands.reserve(bodies);
    outcomes.reserve(bodies);
    loads.reserve(allVertices);
    firstBehind.reserve(allVertices);
    secondBehind.reserve(allVertices);
    begins.reserve(bodies + 1);
  }
};

// All lists of a world in one precision. "By place" is by place in the world's list of bodies.
template <class Real>
struct Workspace {
  PairLists<Real> pairs;
  // By place. A tick does not prepare sleeping bodies: their members and boxes are those of their last tick awake, with
  // the pointers that PairSearch sets anew where it reads them.
  std::vector<Member<Real>> members;
  std::vector<Box> boxes;  // round each body and the way it may go in the tick
  IslandLists<Real> islands;
  std::vector<Outcome> outcomes;       // by place, of the bodies that the tick stepped
  std::vector<std::uint32_t> falling;  // places of the bodies that fall asleep with this tick, ascending
  tbb::enumerable_thread_specific<Scratch<Real>> scratch;

  // For a world of so many bodies.
  void Resize(std::size_t bodies) {
    members.resize(bodies);
    boxes.resize(bodies);
    outcomes.resize(bodies);
    falling.reserve(bodies);
  }

  // Drops what is stored of a body that was removed from `place`. Its pairs must be gone.
  void Forget(std::size_t place) {
    for (BodyPair<Real>& pair : pairs.resting) {
      for (std::uint32_t& other : pair.places) other -= other > place ? 1 : 0;
    }
    if (place >= members.size()) return;
    members.erase(members.begin() + static_cast<std::ptrdiff_t>(place));
    boxes.erase(boxes.begin() + static_cast<std::ptrdiff_t>(place));
  }
};

struct World::Engine {
  explicit Engine(const WorldSettings& settings) : threads(settings.threads) {
    if (settings.precision == Precision::kDouble) workspace.emplace<Workspace<double>>();
  }

  // Drops what is stored of the body at `place`, which is being removed.
  void Forget(std::size_t place, const Body& body) {
    roster.Remove(static_cast<std::uint32_t>(place), body.asleep);
    for (std::uint32_t& other : stepped) other -= other > place ? 1 : 0;
    std::visit([place](auto& work) { work.Forget(place); }, workspace);
  }

  Threads threads;
  Roster roster;
  std::vector<std::uint32_t> stepped;   // places of the bodies that the last tick stepped, ascending
  Vector3d gravity = Vector3d::Zero();  // of the last tick, m/s²
  std::variant<Workspace<float>, Workspace<double>> workspace;  // in the world's precision
};

[[nodiscard]] inline StiffnessRule FindStiffnessRule(const WorldSettings& settings, const BlueprintSlot& slot) {
  return {.ofWorld = settings.stiffnessFactor, .bound = slot.stiffnessBound};
}

}  // namespace wobble::physics
