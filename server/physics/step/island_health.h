// Whether a step has left an island in a possible state, and which members are to blame when it has not.
#pragma once

#include "server/physics/step/body_system.h"

namespace wobble::physics {

// Writes `after`, `health` and `lost` of each member of the island; returns whether any is bad. checkEnergy: also looks
// for energy that the island gained without a source. Use it only with methods that add none of themselves. Costs two
// sums over the vertices; with a suspicion of gained energy also the elastic energies.
template <class Real>
[[nodiscard]] bool FindBadMembers(const BodySystem<Real>& system, const Island& island, bool checkEnergy);

// Blames members that were in an impossible state when the tick began, which no number of substeps can mend: marks them
// alone as lost and puts the whole island back to the tick's begin. Returns false and changes nothing when there are
// none.
template <class Real>
[[nodiscard]] bool BlameMembersBadFromStart(const BodySystem<Real>& system, const Island& island);

}  // namespace wobble::physics
