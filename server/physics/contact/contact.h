// The room physics/contact decides what touches what and with which force. This file: vertices of a body against the
// surfaces of static obstacles, by the two laws that are forces (backtracking.h has the third), and the search for
// vertices that may touch in a tick. A body's own surface is called its skin.
//
// Penalty, the default.
// Normal force at depth d with rate ḋ:  N = max(0, F(d) + c·s(d)·ḋ),
//   F = k d²/2δ up to δ, then k (d − δ/2): C¹, slope at most k;
//   s = smoothstep(d/δ): damping that sets in with depth (Hunt & Crossley 1975), since a dashpot that begins at full
//   strength on touching breaks C¹ and costs RK4 two orders through a bounce.
// Friction (Cundall & Strack 1979): a stick spring from an anchor with a dashpot beside it, f = k_t (x − anchor)ₜ + c_t
// vₜ, cut to Coulomb's μN. The anchor is where the vertex came through the surface, and it is dragged along when the
// spring alone would pull harder than μF. An anchor set where the vertex is when the substep ends leaves out what it
// has slid since it came in, always in the same sense: eight players who chased one another were 2.5 mm off after a
// second of four substeps a tick, and are 0.6 mm off with the anchor where it belongs. Friction regularised by slip
// speed alone lets a body that should stick creep downhill.
//
// Magnetic: N = K/d² at distance d above the surface, without friction and damping: nothing touches. Below the distance
// d_m at which the slope 2K/d_m³ is k, the force goes on along its tangent, N = K/d_m² (3 − 2d/d_m), through the
// surface and below: finite and C¹, and never stiffer than the penalty. A smoothstep fades it out between half the
// range and all of it, where it would carry 4 % and 1 % of a vertex.
#pragma once

#include <span>
#include <vector>

#include "server/physics/contact/obstacle.h"
#include "server/physics/model/blueprint.h"
#include "server/physics/model/state.h"
#include "server/physics/model/survey.h"
#include "server/physics/model/vector.h"

namespace wobble::physics {

// Margin of every search for contacts, m, beyond the way that a body or vertex goes in the tick at its present speed:
// gravity and springs may make it faster.
inline constexpr double kNearMargin = 0.02;

// The distance, m, and the normal of the contact's surface at x, where its vertex is. A buried contact is at kBeyond:
// the vertex feels nothing. In a box the nearest face is not always the one that the vertex came in through: a fast
// vertex is past the middle of a wall before it is stopped, and would be pushed out on the far side. So if the normal
// has turned round since the contact was last looked at, the face of Contact::side counts.
template <class Real>
[[nodiscard]] SurfacePoint<Real> FindOtherContactPoint(const Surface<Real>& surface, const Contact<Real>& contact,
                                                       const Vector3<Real>& x);
template <class Real>
[[nodiscard]] inline SurfacePoint<Real> FindContactPoint(const Surface<Real>& surface, const Contact<Real>& contact,
                                                         const Vector3<Real>& x) {
  if (surface.kind != Obstacle::Kind::kPlane) return FindOtherContactPoint(surface, contact, x);
  return FindSurfacePoint(surface, x);
}

// One body and the surfaces around it at the beginning of a tick, all in the body's local coordinates.
template <class Real>
struct SurfaceSearch {
  std::span<const Surface<Real>> surfaces;
  std::span<const Vector3<Real>> x;  // of all vertices, m
  std::span<const Vector3<Real>> v;  // m/s
  Survey<Real> survey;               // of x and v
  Real range = 0;                    // ContactParameters::range, m
  Real duration = 0;                 // of the tick, s
};

// Replaces `contacts` by one contact for each vertex and surface that may come within `range` of one another before
// `duration` is over, sorted by surface, then vertex. A contact that was in the old list keeps its anchor, slip and
// burial. `scratch` is overwritten; it only saves allocations. Cost: one clearance for each surface that is far off;
// otherwise a look at every vertex, a few operations for a plane.
template <class Real>
void FindContacts(const SurfaceSearch<Real>& search, std::vector<Contact<Real>>& contacts,
                  std::vector<Contact<Real>>& scratch);

// Adds the contact forces, N, to `forces`, one a vertex. shares: Coefficients::contactShares. Nothing under
// backtracking, which is no force.
template <class Real>
void AddContacts(const ContactParameters<Real>& parameters, std::span<const Real> shares,
                 std::span<const Surface<Real>> surfaces, std::span<const Contact<Real>> contacts,
                 std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v, std::span<Vector3<Real>> forces);

// The linearised law: how a contact resists small motions of its vertex along the normal and across it, N/m and N·s/m.
template <class Real>
struct ContactStiffness {
  Vector3<Real> normal = Vector3<Real>::UnitZ();
  Real stiffness = 0;
  Real damping = 0;
  Real stickStiffness = 0;
  Real stickDamping = 0;
};
// Friction that Coulomb's limit cuts counts by the share that is left of it. All zero while the contact does not push.
template <class Real>
[[nodiscard]] ContactStiffness<Real> FindContactStiffness(
    const ContactParameters<Real>& parameters, std::span<const Real> shares, std::span<const Surface<Real>> surfaces,
    const Contact<Real>& contact, std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v);

// After a substep of h s, with the vertices at x and v: sets, drags and drops anchors. A magnetic contact has no
// anchor; it is `touching` while the surface is felt, within half the range, so that a body that hovers may jump.
template <class Real>
void UpdateAnchors(const ContactParameters<Real>& parameters, std::span<const Surface<Real>> surfaces,
                   std::span<Contact<Real>> contacts, Real h, std::span<const Vector3<Real>> x,
                   std::span<const Vector3<Real>> v);

// The force of the stick spring, N, that is `slip` m long, along the surface, at this depth, m: no more than Coulomb's
// limit, as if the anchor were dragged at once; a spring that is cut between substeps only pulls too hard within them
// (errors are a fifth larger). friction: the product of the body's and the surface's coefficient.
template <class Real>
[[nodiscard]] Vector3<Real> FindStickPull(const ContactParameters<Real>& parameters, Real friction, Real depth,
                                          const Vector3<Real>& slip) {
  const Real limit = friction * ComputePenalty(parameters, depth);
  const Real strength = parameters.stickStiffness * std::sqrt(slip.dot(slip));
  return slip * (strength > limit ? parameters.stickStiffness * (limit / strength) : parameters.stickStiffness);
}

// The stick spring of a contact that has begun within the last substep, of h s, m: the way along the surface since the
// vertex came through it. velocity: against the surface at the substep's end, m/s. Rejected: to count in how much the
// contact has slowed the vertex down since, and to let the spring act within that substep already; neither changed the
// error.
template <class Real>
[[nodiscard]] Vector3<Real> FindFirstSlip(Real h, Real depth, const Vector3<Real>& normal,
                                          const Vector3<Real>& velocity) {
  const Real approach = -normal.dot(velocity);
  const Real time = approach * h > depth ? depth / approach : h;
  return time * RemoveNormalPart<Real>(velocity, normal);
}

// The new anchor of a touching contact whose vertex is at x and `depth` m deep. friction: the product of the body's and
// the surface's coefficient.
template <class Real>
[[nodiscard]] Vector3<Real> DragAnchor(const ContactParameters<Real>& parameters, Real friction, Real depth,
                                       const Vector3<Real>& normal, const Vector3<Real>& x,
                                       const Vector3<Real>& anchor) {
  const Vector3<Real> slip = RemoveNormalPart<Real>(x - anchor, normal);
  const Real limit = friction * ComputePenalty(parameters, depth);
  const Real strength = parameters.stickStiffness * std::sqrt(slip.dot(slip));
  return strength > limit ? Vector3<Real>(x - slip * (limit / strength)) : anchor;
}

// The energy that the springs of penalty contacts hold, normal and stick, J; 0 for the other laws.
template <class Real>
[[nodiscard]] double ComputeContactEnergy(const Coefficients<Real>& body, std::span<const Surface<Real>> surfaces,
                                          std::span<const Contact<Real>> contacts, std::span<const Vector3<Real>> x);

// ∫ F dd up to depth d, J: k d³/6δ up to δ, then k (d²/2 − dδ/2 + δ²/6). Zero for d <= 0.
template <class Real>
[[nodiscard]] Real ComputePenaltyEnergy(const ContactParameters<Real>& parameters, Real depth);

// F(d), N, and its slope dF/dd, N/m. Both are zero for d <= 0.
template <class Real>
[[nodiscard]] Real ComputePenalty(const ContactParameters<Real>& parameters, Real depth);
template <class Real>
[[nodiscard]] Real ComputePenaltySlope(const ContactParameters<Real>& parameters, Real depth);
// The normal force N of the law at depth d > 0 m that grows at `rate` m/s, N; at least 0.
template <class Real>
[[nodiscard]] Real ComputeNormalForce(const ContactParameters<Real>& parameters, Real depth, Real rate);
// s(d), 0..1.
template <class Real>
[[nodiscard]] Real ComputeDampingShare(const ContactParameters<Real>& parameters, Real depth);

// Magnetic N at a distance, m, and its slope −dN/dd, N/m; the distance may be negative.
template <class Real>
[[nodiscard]] Real ComputeMagneticForce(const ContactParameters<Real>& parameters, Real distance);
template <class Real>
[[nodiscard]] Real ComputeMagneticSlope(const ContactParameters<Real>& parameters, Real distance);

// The depth, m, that a vertex at `depth` (negative while outside) reaches in `duration` s if it comes nearer at
// `approach` m/s and is not stopped. Its own spring cannot be relied on to stop it: the weight of the body may press
// behind it.
[[nodiscard]] inline double PredictDepth(double depth, double approach, double duration) {
  return approach > 0 ? depth + approach * duration : depth;
}

// What contacts ask of a body's step: the largest square of an angular frequency, 1/s², and the largest damping rate,
// 1/s, that they give a vertex.
struct ContactRates {
  double squareFrequency = 0;
  double dampingRate = 0;

  // Of what acts beside one another on a vertex: stiffnesses and dampings add up.
  friend ContactRates operator+(const ContactRates& a, const ContactRates& b) {
    return {a.squareFrequency + b.squareFrequency, a.dampingRate + b.dampingRate};
  }
};
// The rates of one vertex that will be at `depth`, m, negative outside. mass: the vertex's mass over its contact share,
// kg.
template <class Real>
[[nodiscard]] ContactRates FindRates(const ContactParameters<Real>& parameters, double depth, double mass);

// The parameters of the penalty law that follow from a material. vertexMass: of one vertex, kg; size: Blueprint::size,
// m. The ranges of the material are checked where scenes are read.
[[nodiscard]] ContactParameters<double> MakeContactParameters(const Material& material, double vertexMass, double size);
// Sets the strength K, N·m², and the distances of the magnetic law that follow from it.
void FillMagneticLaw(ContactParameters<double>& parameters, double strength, double vertexMass);

}  // namespace wobble::physics
