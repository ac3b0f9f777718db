// Whether what a step has made of a body can be.
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
  kRunaway,    // its island has gained energy that nobody put in
  kInverted,   // a closed body turned inside out
  kNonFinite,  // a coordinate is no number
};

// insideOut: whether the gas of the body is.
[[nodiscard]] Health FindHealth(const BulkMotion& bulk, bool insideOut);

// Energy that a island may gain beyond what was put in, as a share of what it has: honest play stays under 0.6 %,
// whatever falls onto whatever.
inline constexpr double kRunawayShare = 0.05;

// What can be turned into motion within a tick by forces that are constant through it: kinetic energy less the work of
// the load, ½ Σ m v² − Σ (m a + f)·x. J.
template <class Real>
[[nodiscard]] double ComputeMotionEnergy(const Blueprint& blueprint, const Load<Real>& load, const BulkMotion& bulk,
                                         std::span<const Vector3<Real>> x);

struct ElasticEnergy {
  double stored = 0;  // of springs, repulsion and contacts with static surfaces, J
  double gas = 0;     // up to a constant, J
};
// scratch saves allocations.
template <class Real>
[[nodiscard]] ElasticEnergy ComputeElasticEnergy(const Blueprint& blueprint, const Load<Real>& load,
                                                 std::span<const Surface<Real>> surfaces,
                                                 std::span<const Contact<Real>> contacts,
                                                 std::span<const Vector3<Real>> x, std::vector<Vector3d>& scratch);

}  // namespace wobble::physics
