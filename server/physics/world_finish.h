// The last phases of a tick: what the step has made of each body, which bodies fall asleep, and the report.
#pragma once

#include <cstdint>
#include <span>

#include "server/physics/pair_search.h"
#include "server/physics/world_engine.h"
#include "server/physics/world_prepare.h"

namespace wobble::physics {

// Completes the bodies of an island that has been stepped: a lost body goes back into its rest shape, away from what it
// touched; of the others errors and motion are recorded, springs tear and the origin follows. Looks at no other island.
template <class Real>
void FinishIsland(const Surroundings& surroundings, std::span<const BlueprintSlot> slots, double allowedError,
                  std::uint32_t island, const IslandOutcome& steps, std::span<Body> bodies, Workspace<Real>& work);

// Puts the quiet islands (step/sleep.h) asleep, with the pairs among them.
template <class Real>
void LetFallAsleep(double tickDuration, std::span<Body> bodies, Roster& roster, PairSearch<Real>& search,
                   Workspace<Real>& work);

// stepped: places of the bodies that the tick stepped, ascending.
[[nodiscard]] StepReport MakeReport(std::span<const std::uint32_t> stepped, std::span<const Body> bodies,
                                    std::span<const Outcome> outcomes);

}  // namespace wobble::physics
