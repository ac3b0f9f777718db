// How many substeps the first try of an island's tick takes: the most that any of its members needs for stability or
// for the error of its last ticks.
#pragma once

#include <span>

#include "server/physics/model/integrator.h"
#include "server/physics/step/member.h"

namespace wobble::physics {

// The method that steps these members: their own where all have the same, else RK4. Bodies that touch are stepped as
// one system by one method, and where they differ none of theirs suits all.
template <class Real>
[[nodiscard]] Integrator FindIntegrator(std::span<Member<Real>* const> members);

// For the members of one island, linked by these contact pairs, as their own states are. contactPairs refer to indices
// in `members`. loads, begins: scratch. Cost: a loop over the contacts of the pairs and the modes of each member.
template <class Real>
[[nodiscard]] int FindFirstSubsteps(std::span<Member<Real>* const> members,
                                    std::span<const ContactPair<Real>> contactPairs, const StepRules& rules,
                                    std::vector<VertexLoad>& loads, std::vector<std::size_t>& begins);

}  // namespace wobble::physics
