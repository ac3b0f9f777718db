// Whether a step has left a island in a state that can be, and who is to blame when not.
#pragma once

#include "server/physics/step/body_system.h"

namespace wobble::physics {

// Notes the health of each member of the part and which are lost; false when all is well. checkEnergy: also looks for
// energy from nowhere, which only methods that have none to give can be blamed for.
template <class Real>
[[nodiscard]] bool FindBadMembers(const BodySystem<Real>& system, const Island& island, bool checkEnergy);

// No step can help a member that began the tick in a state that cannot be. It alone is lost then, and what it has
// touched goes back to where it began. False, and nothing done, when none began so.
template <class Real>
[[nodiscard]] bool BlameThoseWhoBeganBad(const BodySystem<Real>& system, const Island& island);

}  // namespace wobble::physics
