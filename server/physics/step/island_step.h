// One tick of one island in plain code: the reference for the lanes (batch_step.h), and the step for islands that the
// lanes cannot take: those whose method is not RK4, and those with a body of which CanGoInPack is false. A body alone
// is an island of one member.
#pragma once

#include <span>

#include "server/physics/step/body_system.h"

namespace wobble::physics {

// Steps all members through a tick in equal substeps, the first try in as many as are given. A tick that missed its
// error by far is stepped again in more substeps; one that left a member in an impossible state is stepped again in 2,
// 4, 8 and 16 times as many, and a member that is still bad after that is marked `lost` (island_tick.h). contactPairs:
// between these members only, by their index in `members`. threads: shares the members out; null: the calling thread
// does all. The result does not depend on it.
template <class Real>
IslandOutcome StepIsland(std::span<Member<Real>* const> members, std::span<const ContactPair<Real>> contactPairs,
                         int substeps, const StepRules& rules, Threads* threads, SystemScratch<Real>& scratch);

}  // namespace wobble::physics
