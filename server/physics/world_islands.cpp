// An island is stepped by one thread from beginning to end, or, when it is too large for that, by all threads body by
// body. Nothing is summed across threads, so the result does not depend on their number.
#include "server/physics/world_islands.h"

#include <algorithm>

#include "server/physics/step/first_substeps.h"
#include "server/physics/step/island_step.h"

namespace wobble::physics {
namespace {

// Fewest vertices of an island that all threads step: in smaller ones they would wait for one another longer than they
// work.
constexpr std::size_t kLargeIsland = 2000;

// Most bodies of several islands that are stepped together: their packs should stay in a core's own cache.
constexpr std::size_t kMostTogether = 32;
// Batches for each of several threads, if their packs are full then: fewer would leave threads without work at the end.
constexpr std::size_t kBatchesOfThread = 4;

template <class Real>
AwakeIsland DescribeIsland(std::uint32_t island, std::span<const Body> bodies, std::span<const Member<Real>> members,
                           IslandLists<Real>& lists) {
  using Way = AwakeIsland::Way;
  const std::span<const std::uint32_t> places = lists.islands.MembersOf(island);
  AwakeIsland described;
  described.island = island;
  bool inLanes = true;
  for (const std::uint32_t place : places) {
    const std::size_t vertices = members[place].state->positions.size();
    described.vertices += vertices;
    lists.mostVertices = std::max(lists.mostVertices, vertices);
    inLanes = inLanes && CanGoInPack<Real>(*members[place].blueprint);
  }
  lists.allVertices += described.vertices;
  if (inLanes) described.way = lists.ContactPairsOf(island).empty() ? Way::kAlone : Way::kTogether;
  if (described.way == Way::kAlone) described.blueprint = bodies[places[0]].blueprint;
  return described;
}

// Sorts the pairs by island, by counting; within an island they keep their order.
template <class Real>
void FindContactPairs(std::span<const Member<Real>> members, PairLists<Real>& pairs, IslandLists<Real>& lists) {
  std::vector<std::size_t>& begins = lists.contactPairBegins;
  begins.assign(lists.islands.Count() + 1, 0);
  const auto islandOf = [&](std::size_t pair) { return lists.islands.IslandOf(pairs.places[pair][0]); };
  for (std::size_t i = 0; i < pairs.awake.size(); ++i) ++begins[islandOf(i) + 1U];
  for (std::size_t island = 0; island + 1 < begins.size(); ++island) begins[island + 1] += begins[island];
  lists.contactPairs.resize(pairs.awake.size());
  for (std::size_t i = pairs.awake.size(); i-- > 0;) {
    const auto [a, b] = pairs.places[i];
    const auto& ofA = members[a].blueprint->template Read<Real>().contact;
    const auto& ofB = members[b].blueprint->template Read<Real>().contact;
    lists.contactPairs[--begins[islandOf(i) + 1U]] = {.members = {lists.memberOf[a], lists.memberOf[b]},
                                                      .parameters = Combine(ofA, ofB),
                                                      .gap = pairs.awake[i].gap,
                                                      .sides = {&pairs.awake[i].sides[0], &pairs.awake[i].sides[1]},
                                                      .edges = &pairs.awake[i].edges,
                                                      .core = &pairs.awake[i].core,
                                                      .tangle = &pairs.awake[i].tangle};
  }
  // begins[island + 1] has been counted down from the end of the island's pairs to their begin: shift by one.
  begins.erase(begins.begin());
  begins.push_back(pairs.awake.size());
}

// Marks the islands that are more than one thread's share of the work. Threads that step different islands need not
// wait for one another before every stage, so all others go to one thread each.
void MarkLarge(const Islands& islands, int threadCount, std::span<AwakeIsland> awake) {
  const auto work = [](const AwakeIsland& island) {
    return island.vertices * static_cast<std::size_t>(island.substeps);
  };
  std::size_t all = 0;
  for (const AwakeIsland& island : awake) all += work(island);
  for (AwakeIsland& island : awake) {
    island.isLarge = islands.MembersOf(island.island).size() > 1 && island.vertices >= kLargeIsland &&
                     work(island) * static_cast<std::size_t>(threadCount) > all;
  }
}

// Cuts the sorted islands into batches. Islands of one batch ask for equal substeps. Bodies alone fill one pack;
// islands of several bodies, which are stepped stage by stage, come together until their packs have few lanes to spare.
void CutIntoBatches(const Islands& islands, std::span<const AwakeIsland> awake, std::size_t lanes,
                    std::size_t threadCount, std::vector<std::size_t>& begins) {
  using Way = AwakeIsland::Way;
  std::size_t together = kMostTogether;
  if (threadCount > 1) {
    const std::size_t bodiesOfBatch = islands.CountMembers() / (threadCount * kBatchesOfThread);
    together = std::clamp(bodiesOfBatch, std::min(lanes, kMostTogether), kMostTogether);
  }
  begins.clear();
  begins.reserve(awake.size() + 1);
  std::size_t bodies = 0;
  for (std::size_t i = 0; i < awake.size(); ++i) {
    const AwakeIsland& island = awake[i];
    const std::size_t own = islands.MembersOf(island.island).size();
    const bool fits = i > 0 && island.way != Way::kPlain && !island.isLarge && island.way == awake[i - 1].way &&
                      island.blueprint == awake[i - 1].blueprint && island.substeps == awake[i - 1].substeps &&
                      bodies + own <= (island.way == Way::kAlone ? lanes : together);
    if (!fits) {
      begins.push_back(i);
      bodies = 0;
    }
    bodies += own;
  }
  begins.push_back(awake.size());
}

// Fills in the batch's members, contact pairs and islands, in the scratch of this thread.
template <class Real>
Scratch<Real>& CollectBatch(std::span<const AwakeIsland> batch, Workspace<Real>& work) {
  const IslandLists<Real>& lists = work.islands;
  Scratch<Real>& scratch = work.scratch.local();
  scratch.Reserve(lists.allVertices, work.members.size());
  scratch.members.clear();
  scratch.contactPairs.clear();
  scratch.islands.clear();
  for (const AwakeIsland& each : batch) {
    Island island;
    island.memberBegin = scratch.members.size();
    island.contactPairBegin = scratch.contactPairs.size();
    for (ContactPair<Real> contactPair : lists.ContactPairsOf(each.island)) {
      for (std::uint32_t& member : contactPair.members) member += static_cast<std::uint32_t>(island.memberBegin);
      scratch.contactPairs.push_back(contactPair);
    }
    for (const std::uint32_t place : lists.islands.MembersOf(each.island)) {
      scratch.members.push_back(&work.members[place]);
    }
    island.memberEnd = scratch.members.size();
    island.contactPairEnd = scratch.contactPairs.size();
    scratch.islands.push_back(island);
  }
  scratch.outcomes.assign(batch.size(), {});
  return scratch;
}

}  // namespace

template <class Real>
void FindAwakeIslands(std::span<const std::uint32_t> awake, std::span<const Body> bodies,
                      std::span<const Member<Real>> members, PairLists<Real>& pairs, IslandLists<Real>& lists) {
  lists.islands.Find(awake, pairs.places);
  lists.memberOf.resize(bodies.size());
  lists.awake.clear();
  lists.awake.reserve(bodies.size());
  lists.batchOrder.reserve(bodies.size());
  lists.batchWork.reserve(bodies.size());
  lists.mostVertices = 0;
  lists.allVertices = 0;
  for (std::uint32_t island = 0; island < lists.islands.Count(); ++island) {
    const std::span<const std::uint32_t> places = lists.islands.MembersOf(island);
    for (std::uint32_t i = 0; i < places.size(); ++i) lists.memberOf[places[i]] = i;
  }
  FindContactPairs<Real>(members, pairs, lists);
  for (std::uint32_t island = 0; island < lists.islands.Count(); ++island) {
    lists.awake.push_back(DescribeIsland<Real>(island, bodies, members, lists));
  }
}

template <class Real>
void MakeBatches(const StepRules& rules, int lanes, int threadCount, Threads& threads, Workspace<Real>& work) {
  std::vector<AwakeIsland>& awake = work.islands.awake;
  threads.ForEach(awake.size(), [&](std::size_t i) {
    Scratch<Real>& scratch = CollectBatch<Real>({&awake[i], 1}, work);
    awake[i].substeps =
        FindFirstSubsteps<Real>(scratch.members, scratch.contactPairs, rules, scratch.loads, scratch.begins);
    const bool isRungeKutta = FindIntegrator<Real>(scratch.members) == Integrator::kRungeKutta4;
    if (!isRungeKutta) awake[i].way = AwakeIsland::Way::kPlain;
  });
  MarkLarge(work.islands.islands, threadCount, awake);
  std::sort(awake.begin(), awake.end());
  CutIntoBatches(work.islands.islands, awake, static_cast<std::size_t>(lanes), static_cast<std::size_t>(threadCount),
                 work.islands.batchBegins);
}

template <class Real>
void StepOneBatch(std::span<const AwakeIsland> batch, const StepRules& rules,
                  std::span<const SweepKernel<Real>> kernels, Threads* threads, Workspace<Real>& work) {
  Scratch<Real>& scratch = CollectBatch(batch, work);
  scratch.batch.Reserve(work.islands.mostVertices, work.islands.allVertices, work.members.size());
  const int substeps = batch[0].substeps;
  if (batch[0].way == AwakeIsland::Way::kPlain) {
    scratch.outcomes[0] =
        StepIsland<Real>(scratch.members, scratch.contactPairs, substeps, rules, threads, scratch.batch.system);
  } else {
    StepBatch<Real>(scratch.members, scratch.contactPairs, scratch.islands, substeps, rules, kernels, threads,
                    scratch.batch, scratch.outcomes);
  }
}

template void FindAwakeIslands<float>(std::span<const std::uint32_t>, std::span<const Body>,
                                      std::span<const Member<float>>, PairLists<float>&, IslandLists<float>&);
template void FindAwakeIslands<double>(std::span<const std::uint32_t>, std::span<const Body>,
                                       std::span<const Member<double>>, PairLists<double>&, IslandLists<double>&);
template void MakeBatches<float>(const StepRules&, int, int, Threads&, Workspace<float>&);
template void MakeBatches<double>(const StepRules&, int, int, Threads&, Workspace<double>&);
template void StepOneBatch<float>(std::span<const AwakeIsland>, const StepRules&, std::span<const SweepKernel<float>>,
                                  Threads*, Workspace<float>&);
template void StepOneBatch<double>(std::span<const AwakeIsland>, const StepRules&, std::span<const SweepKernel<double>>,
                                   Threads*, Workspace<double>&);

}  // namespace wobble::physics
