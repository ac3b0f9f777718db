// Contacts between obstacles and the springs of bodies without faces. A spring is a rod, a capsule of the radius of its
// ends; the ends have contacts of their own (contact.h). What lies between them meets what is smaller than the rod is
// long: a sphere, a capsule, the edge of a box, a ridge of the ground. A plane is met by the ends alone.
//
// p = (1 − s) a + s b is the rod's deepest point in the surface, found anew for each force, d its depth there, and
// e = max(0, dₐ, d_b) that of the deeper end. D = d − e is the depth of the rod: a rod that lies on a flat side pushes
// with its ends alone, and the force sets in at 0 where the deepest point leaves an end. It is the gradient of the
// penalty's energy at D: N n at p, split by 1 − s and s between the ends, for ∂d/∂s = 0; and if e > 0, −N n at that
// end, so that it and the rod share the load. Without the latter an end that left a box sideways, deep below its top,
// left the rod behind at this depth: energy from nowhere.
//
// Nothing lives on from tick to tick. So friction is that of a dashpot, cut at Coulomb's limit: a rod that hangs over
// an edge creeps.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/physics/contact/contact.h"

namespace wobble::physics {

// A spring that may come into a surface before the tick is over.
struct NearRod {
  std::uint32_t surface = 0;
  std::uint16_t a = 0;  // the vertices at its ends
  std::uint16_t b = 0;
};

// Fills in `rods`, by surface, then spring. torn: State::torn. Nothing unless the body's law is the penalty. Cost: one
// clearance for each surface that is far off; otherwise one for each spring.
template <class Real>
void FindNearRods(const Coefficients<Real>& body, std::span<const std::uint8_t> torn, const SurfaceSearch<Real>& search,
                  std::vector<NearRod>& rods);

// Adds the forces, N, to `forces`, one a vertex.
template <class Real>
void AddRodContacts(const Coefficients<Real>& body, std::span<const Surface<Real>> surfaces,
                    std::span<const NearRod> rods, std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v,
                    std::span<Vector3<Real>> forces);

// The energy that the contacts hold, J.
template <class Real>
[[nodiscard]] double ComputeRodContactEnergy(const Coefficients<Real>& body, std::span<const Surface<Real>> surfaces,
                                             std::span<const NearRod> rods, std::span<const Vector3<Real>> x);

// What rods demand of a tick.
struct RodDemands {
  ContactRates rates;  // the largest of a vertex
  double landing = 0;  // substeps that resolve a landing (methods/stability.h)
};
// agitation: Survey::agitation, m/s. duration: of the tick, s. scratch is overwritten. O(rods²).
template <class Real>
[[nodiscard]] RodDemands FindRodDemands(const Coefficients<Real>& body, std::span<const Surface<Real>> surfaces,
                                        std::span<const NearRod> rods, std::span<const Vector3<Real>> x,
                                        std::span<const Vector3<Real>> v, double agitation, double duration,
                                        std::vector<ContactRates>& scratch);

}  // namespace wobble::physics
