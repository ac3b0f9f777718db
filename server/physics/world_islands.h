// The middle phases of a tick: which awake bodies touch and form islands, and the stepping of the islands in batches.
#pragma once

#include <cstdint>
#include <span>

#include "server/physics/world_engine.h"

namespace wobble::physics {

// Fills in the islands of the awake bodies, with their contact pairs, in lists.awake: in the order of their least
// member, not yet with substeps, and not yet in batches. awake: places, ascending.
template <class Real>
void FindAwakeIslands(std::span<const std::uint32_t> awake, std::span<const Body> bodies,
                      std::span<const Member<Real>> members, PairLists<Real>& pairs, IslandLists<Real>& lists);

// Chooses the substeps of each island's first try, and makes the batches.
template <class Real>
void MakeBatches(const StepRules& rules, int lanes, int threadCount, Threads& threads, Workspace<Real>& work);

// Steps the bodies of all batches. finish(island, outcome) is called for each island when it has been stepped, on the
// thread that stepped it, while its bodies are still in that thread's cache.
template <class Real, class Finish>
void StepBatches(const StepRules& rules, std::span<const SweepKernel<Real>> kernels, Threads& threads,
                 Workspace<Real>& work, const Finish& finish);

// Steps one batch; its outcomes are then in the scratch, one an island. threads: null to step it on this thread alone.
template <class Real>
void StepOneBatch(std::span<const AwakeIsland> batch, const StepRules& rules,
                  std::span<const SweepKernel<Real>> kernels, Threads* threads, Workspace<Real>& work);

template <class Real, class Finish>
void StepBatches(const StepRules& rules, std::span<const SweepKernel<Real>> kernels, Threads& threads,
                 Workspace<Real>& work, const Finish& finish) {
  const auto step = [&](std::size_t index, Threads* within) {
    const std::span<const AwakeIsland> batch = work.islands.Batch(index);
    StepOneBatch(batch, rules, kernels, within, work);
    const std::vector<IslandOutcome>& outcomes = work.scratch.local().outcomes;
    for (std::size_t i = 0; i < batch.size(); ++i) finish(batch[i].island, outcomes[i]);
  };
  std::size_t small = work.islands.CountBatches();
  while (small > 0 && work.islands.Batch(small - 1)[0].isLarge) step(--small, &threads);
  work.islands.SortByWork(small);
  threads.ForEachInTurn(small, [&](std::size_t i) { step(work.islands.batchOrder[i], nullptr); });
}

}  // namespace wobble::physics
