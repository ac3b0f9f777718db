// One tick of bodies in lanes: those that ask for the same number of substeps are stepped together, in packs of one
// blueprint, whether they touch one another or not. Bodies that touch go stage by stage, since each stage's forces
// between them come from its own positions.
#pragma once

#include <deque>
#include <span>
#include <vector>

#include "server/physics/step/pack.h"

namespace wobble::physics {

// Whether the body's own blueprint lets it be stepped in lanes, where it is RK4 that steps it.
template <class Real>
[[nodiscard]] bool CanGoInPack(const Blueprint& blueprint);

// Reused from batch to batch.
template <class Real>
struct BatchScratch {
  SystemScratch<Real> system;
  std::vector<std::uint32_t> order;  // of the members, those of one blueprint behind one another
  std::vector<Pack<Real>> packs;
  std::deque<PackScratch<Real>> packScratches;  // as many as the largest batch so far had packs
  // Of a part that has to be stepped again, alone.
  SystemScratch<Real> again;
  std::vector<ContactPair<Real>> contactPairsAgain;

  // For so many bodies with so many vertices in all, the largest with mostVertices.
  void Reserve(std::size_t mostVertices, std::size_t allVertices, std::size_t bodies);
};

// As StepIsland, for several islands at once that all begin with `substeps`: members and contact pairs of one are a
// part, and outcomes has one a island. The islands cover all members and contact pairs, in their order.
template <class Real>
void StepBatch(std::span<Member<Real>* const> members, std::span<const ContactPair<Real>> contactPairs,
               std::span<const Island> islands, int substeps, const StepRules& rules,
               std::span<const SweepKernel<Real>> kernels, Threads* threads, BatchScratch<Real>& scratch,
               std::span<IslandOutcome> outcomes);

// Equal substeps through `duration` s of bodies that touch no other, with nobody to choose or judge them: for the
// laboratory.
template <class Real>
void IntegrateBatch(std::span<Member<Real>* const> members, double duration, int substeps,
                    std::span<const SweepKernel<Real>> kernels, BatchScratch<Real>& scratch);

}  // namespace wobble::physics
