// Vertices against static surfaces: the default law, and who may touch what this tick.
//
// Normal force at depth d with rate ḋ:  N = max(0, F(d) + c·s(d)·ḋ),
//   F = k d²/2δ up to δ, then k (d − δ/2): C¹, slope at most k;
//   s = smoothstep(d/δ): damping that sets in with depth (Hunt & Crossley 1975), since a dashpot that begins at full
//   strength on touching breaks C¹ and costs RK4 two orders through a bounce.
// Friction (Cundall & Strack 1979): a stick spring from an anchor with a dashpot beside it, f = k_t (x − anchor)ₜ + c_t
// vₜ, cut to Coulomb's μN. The anchor is set where a vertex first touches and dragged along when the spring alone would
// pull harder than μN. Friction regularised by slip speed alone lets a body that should stick creep downhill.
#pragma once

#include <span>
#include <vector>

#include "server/physics/blueprint.h"
#include "server/physics/bounds.h"
#include "server/physics/obstacle.h"
#include "server/physics/vector.h"

namespace wobble::physics {

// A vertex near a surface. The list is sorted by surface, then vertex; anchors live through it from tick to tick.
template <class Real>
struct Contact {
  std::uint32_t surface = 0;
  std::uint32_t vertex = 0;
  bool touching = false;                         // at the end of the last substep; the anchor is set
  Vector3<Real> anchor = Vector3<Real>::Zero();  // local coordinates, m
  Vector3<Real> side = Vector3<Real>::Zero();    // normal of the surface where the vertex was last; zero: not yet known
};

// Where the vertex of a contact stands to its surface. In a box the face that is nearest is not always the one that it
// came in through: a fast vertex is past the middle of a wall before it is stopped, and would be pushed out on the far
// side. So where the normal has turned round since the contact was last looked at, the side that it had then counts.
template <class Real>
[[nodiscard]] SurfacePoint<Real> FindContactPoint(const Surface<Real>& surface, const Contact<Real>& contact,
                                                  const Vector3<Real>& x);

// Lists every vertex that may touch a surface before `duration` (s) is over, keeping anchors of `contacts`.
// `scratch` saves allocations.
template <class Real>
void FindContacts(std::span<const Surface<Real>> surfaces, const Bounds<Real>& bounds, std::span<const Vector3<Real>> x,
                  std::span<const Vector3<Real>> v, Real duration, std::vector<Contact<Real>>& contacts,
                  std::vector<Contact<Real>>& scratch);

// shares: Coefficients::contactShares.
template <class Real>
void AddContacts(const ContactParameters<Real>& parameters, std::span<const Real> shares,
                 std::span<const Surface<Real>> surfaces, std::span<const Contact<Real>> contacts,
                 std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v, std::span<Vector3<Real>> forces);

// After a substep: sets, drags and drops anchors.
template <class Real>
void UpdateAnchors(const ContactParameters<Real>& parameters, std::span<const Surface<Real>> surfaces,
                   std::span<Contact<Real>> contacts, std::span<const Vector3<Real>> x);

// What the contacts' springs hold, normal and stick, J.
template <class Real>
[[nodiscard]] double ComputeContactEnergy(const Coefficients<Real>& body, std::span<const Surface<Real>> surfaces,
                                          std::span<const Contact<Real>> contacts, std::span<const Vector3<Real>> x);

// Of the normal force at depth d, ∫ F dd: k d³/6δ up to δ, then k (d²/2 − dδ/2 + δ²/6). J.
template <class Real>
[[nodiscard]] Real ComputePenaltyEnergy(const ContactParameters<Real>& parameters, Real depth);

// F(d), N, and its slope dF/dd, N/m. d <= 0: none.
template <class Real>
[[nodiscard]] Real ComputePenalty(const ContactParameters<Real>& parameters, Real depth);
template <class Real>
[[nodiscard]] Real ComputePenaltySlope(const ContactParameters<Real>& parameters, Real depth);
// The law's N at depth d > 0 that grows at `rate`, m/s.
template <class Real>
[[nodiscard]] Real ComputeNormalForce(const ContactParameters<Real>& parameters, Real depth, Real rate);
// s(d), 0..1.
template <class Real>
[[nodiscard]] Real ComputeDampingShare(const ContactParameters<Real>& parameters, Real depth);

// The depth, m, that a vertex at `depth` (negative while outside), coming nearer at `approach` m/s, reaches in
// `duration` s unless it is stopped. Its own spring cannot be relied on to do that: behind it may press the weight of
// the body.
[[nodiscard]] inline double PredictDepth(double depth, double approach, double duration) {
  return approach > 0 ? depth + approach * duration : depth;
}

// What contacts ask of a body's step: the largest square of an angular frequency and the largest damping rate that they
// give a vertex, 1/s² and 1/s.
struct ContactRates {
  double squareFrequency = 0;
  double dampingRate = 0;
};

// The parameters that follow from a material for a vertex of `vertexMass` in a body of `size`.
[[nodiscard]] ContactParameters<double> MakeContactParameters(const Material& material, double vertexMass, double size);

}  // namespace wobble::physics
