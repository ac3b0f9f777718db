// One tick of bodies in lanes of vectors. Islands that ask for the same number of substeps are stepped together, their
// bodies in packs of one blueprint whatever island they belong to. Bodies that touch others go stage by stage, all
// packs at once, because the forces between bodies are computed at each stage's positions; a batch without contact
// pairs goes pack by pack.
#pragma once

#include <deque>
#include <span>
#include <variant>
#include <vector>

#include "server/physics/packs/lane_layout.h"
#include "server/physics/packs/row_layout.h"

namespace wobble::physics {

// Whether bodies of this blueprint can be stepped in lanes, provided that their method is RK4: it has a sweep plan and
// its contact law is not backtracking.
template <class Real>
[[nodiscard]] bool CanGoInPack(const Blueprint& blueprint);

template <class Real>
using AnyPack = std::variant<LanePack<Real>, RowPack<Real>>;

// Reused from batch to batch to save allocations; one batch uses it at a time.
template <class Real>
struct BatchScratch {
  SystemScratch<Real> system;
  std::vector<std::uint32_t> order;  // the members' places, sorted so that bodies that share a pack stand together
  std::vector<AnyPack<Real>> packs;
  std::deque<PackScratch<Real>> packScratches;  // one a pack of the largest batch so far
  // Of an island that is stepped again, alone.
  SystemScratch<Real> again;
  std::vector<ContactPair<Real>> contactPairsAgain;

  // Makes room for so many bodies with allVertices in total, the largest with mostVertices.
  void Reserve(std::size_t mostVertices, std::size_t allVertices, std::size_t bodies);
};

// Steps several islands through a tick as StepIsland does one; the first try of all is in `substeps`. islands: ranges
// of `members` and `contactPairs`, which they cover in order. outcomes: one an island. kernels: ascending by width. The
// result depends neither on the kernels nor on which islands share a batch.
template <class Real>
void StepBatch(std::span<Member<Real>* const> members, std::span<const ContactPair<Real>> contactPairs,
               std::span<const Island> islands, int substeps, const StepRules& rules,
               std::span<const SweepKernel<Real>> kernels, Threads* threads, BatchScratch<Real>& scratch,
               std::span<IslandOutcome> outcomes);

// Integrates bodies that touch no other through `duration` s in equal substeps, without choosing substeps, judging the
// result or repeating anything: for the laboratory, which measures the sweeps alone.
template <class Real>
void IntegrateBatch(std::span<Member<Real>* const> members, double duration, int substeps,
                    std::span<const SweepKernel<Real>> kernels, BatchScratch<Real>& scratch);

}  // namespace wobble::physics
