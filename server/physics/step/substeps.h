// How many substeps the first try of a tick takes: what stability and what the error of the last ticks ask of the body
// among those which touch one another that asks for most.
#pragma once

#include <span>

#include "server/physics/model/integrator.h"
#include "server/physics/step/member.h"

namespace wobble::physics {

// Bodies that touch are stepped as one. Where they ask for different methods none of those is right for all, and what
// they have in common is the default.
template <class Real>
[[nodiscard]] Integrator FindIntegrator(std::span<Member<Real>* const> members);

// For members that hang together by these contact pairs, as they stand in their own states. loads: scratch.
template <class Real>
[[nodiscard]] int FindFirstSubsteps(std::span<Member<Real>* const> members,
                                    std::span<const ContactPair<Real>> contactPairs, const StepRules& rules,
                                    std::vector<VertexLoad>& loads, std::vector<std::size_t>& begins);

}  // namespace wobble::physics
