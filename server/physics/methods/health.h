// Checks whether the state that a step has computed for a body is possible.
#pragma once

#include <cstdint>
#include <span>

#include "server/physics/methods/forces.h"
#include "server/physics/model/blueprint.h"
#include "server/physics/model/survey.h"

namespace wobble::physics {

// From best to worst.
enum class Health : std::uint8_t {
  kGood,
  kRunaway,    // its island has gained energy from nowhere
  kNonFinite,  // a coordinate is not finite
};

// Finds kGood or kNonFinite; kRunaway is judged for an island as a whole.
[[nodiscard]] Health FindHealth(const BulkMotion& bulk);

// A body that has been inside out for so long, s, is put back to its rest shape. Gas turns it out
// within a few ticks if there is enough of it (ComputePressure); else, and for other bodies, there is recovery.h.
inline constexpr double kInvertedTime = 2;

// Energy that an island may gain beyond what was put in, as a share of its energy: honest play stays under 0.6 %,
// whatever falls onto whatever.
inline constexpr double kRunawayShare = 0.05;

// Kinetic energy less the work of the loads that are constant through a tick, J: ½ Σ m v² − Σ (m a + f)·x. The loads
// alone leave it unchanged.
template <class Real>
[[nodiscard]] double ComputeMotionEnergy(const Blueprint& blueprint, const Load<Real>& load, const BulkMotion& bulk,
                                         std::span<const Vector3<Real>> x);

struct ElasticEnergy {
  double stored = 0;  // of springs, tetrahedra, hinges, repulsion and contacts with static surfaces, J
  double gas = 0;     // up to a constant, J
};
// Computed in double precision. scratch saves allocations.
template <class Real>
[[nodiscard]] ElasticEnergy ComputeElasticEnergy(const Blueprint& blueprint, const Load<Real>& load,
                                                 std::span<const Surface<Real>> surfaces,
                                                 std::span<const Contact<Real>> contacts,
                                                 std::span<const Vector3<Real>> x, std::vector<Vector3d>& scratch);

}  // namespace wobble::physics
