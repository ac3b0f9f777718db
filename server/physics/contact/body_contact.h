// Vertices of one body against the faces of another: the law, and who may touch whom this tick.
//
// A vertex p below the plane of a face (a, b, c) at depth d = −n·(p − a), its foot q = Σ wᵢ xᵢ, gets the normal force
// N n of contact.h's law and each corner −wᵢ N n. Since ∂d/∂p = −n and ∂d/∂xᵢ = wᵢ n exactly, this is the gradient of a
// potential, and momentum and angular momentum are kept to rounding. A friction F on p and −wᵢ F on the corners would
// leave the torque (p − q) × F = −d n × F; normal forces −d (F·∇wᵢ) n on the corners, whose sum is none, balance it,
// since Σ (F·∇wᵢ) xᵢ = F.
//
// A contact is armed when the vertex comes from outside. Until then it does nothing: bodies that were put into one
// another drift apart instead of exploding. For the same reason it is disarmed when it is suddenly deeper than it can
// have come, as on a face that a violent impact has folded over.
//
// Where boxes lie edge on edge, the face nearest to a vertex may be one that it only passes by, and would push it
// sideways; so a face must look towards the vertex's own surface if there is one beside it that does.
//
// An open surface has no inside. There a contact keeps to the side that its vertex was seen on first, however deep it
// is behind it, until the vertex leaves past the border: a thin sheet is crossed within one substep, and by where the
// vertex is then nobody could tell.
#pragma once

#include <span>
#include <vector>

#include "server/physics/contact/contact.h"
#include "server/physics/contact/face_search.h"
#include "server/physics/contact/skin_points.h"
#include "server/physics/model/blueprint.h"
#include "server/physics/model/bounds.h"

namespace wobble::physics {

// A vertex near a face. Lists are sorted by vertex; everything in it lives on from tick to tick.
//
// The stick spring's length is `slip` plus what the vertex has moved since the last substep against the point of the
// surface that was then under it. A point that stays on the surface where the contact began would do the same, but on
// a face that is squashed thin its barycentric weights grow without bound, and with them the force's share of every
// tremor of the corners.
template <class Real>
struct BodyContact {
  std::uint16_t vertex = 0;
  std::uint16_t face = 0;
  bool armed = false;
  bool behind = false;    // on the side of an open surface that its normals point away from
  bool touching = false;  // at the end of the last substep; foot and slip are set
  Real maxDepth = 0;      // that it can come to in the next substep, m
  Real depth = 0;         // that was pushed back at the end of the last substep, m; negative outside
  Real leap = 0;          // depth beyond that, which no motion has brought: not pushed back, m
  Vector3<Real> foot = Vector3<Real>::Zero();  // barycentric, of the point of `face` that was under the vertex
  Vector3<Real> slip = Vector3<Real>::Zero();  // of the stick spring then, along the face, m
  // Normal of the vertex's own surface when the tick began; zero: it or the other surface is open.
  Vector3<Real> outward = Vector3<Real>::Zero();
};

// One side of a pair at one moment: a body whose vertices are looked at, and one whose faces are.
template <class Real>
struct Meeting {
  std::span<const Vector3<Real>> x;  // of the vertices' body, in its own local coordinates
  std::span<const Vector3<Real>> v;
  std::span<const Real> shares;  // Coefficients::contactShares of the same
  Skin<Real> skin;               // of the faces' body, in that one's coordinates
  std::span<const Vector3<Real>> skinV;
  Vector3<Real> shift = Vector3<Real>::Zero();  // from the former to the latter
};

// Two materials against one another: springs and dashpots in series (equal ones stay as they are), the geometric mean
// of the frictions.
template <class Real>
[[nodiscard]] ContactParameters<Real> Combine(const ContactParameters<Real>& a, const ContactParameters<Real>& b);

// Depth that may come from nowhere, m: with it comes the energy of a spring that nobody pressed, the more the stiffer
// it is. By stickDamping/stickStiffness, which goes with the time that the contact's vertex takes to swing.
template <class Real>
[[nodiscard]] Real FindFreeDepth(const ContactParameters<Real>& parameters);

// What a side's search goes by, at the beginning of a tick.
template <class Real>
struct ContactSearch {
  const SkinPoints<Real>* vertices = nullptr;  // of the vertices' body
  const SkinPoints<Real>* skin = nullptr;      // of the faces' body
  PointKernel<Real> kernel;
  Bounds<Real> near;  // in the skin's coordinates, fat enough for the time; its speed is that of both
  Real margin = 0;    // m, for what a vertex's present motion does not tell
  Real duration = 0;  // s
};

// Saves allocations.
template <class Real>
struct ContactSearchScratch {
  std::vector<BodyContact<Real>> contacts;
  std::vector<std::uint16_t> found;
};

// Lists every surface vertex that may touch the other body before the time is over, keeping what is known of
// `contacts`. own: the surface that the vertices belong to.
template <class Real>
void FindBodyContacts(const ContactParameters<Real>& parameters, const Meeting<Real>& meeting, const Skin<Real>& own,
                      const ContactSearch<Real>& search, std::vector<BodyContact<Real>>& contacts,
                      ContactSearchScratch<Real>& scratch);

// What one contact does, N. Computed for all contacts first and added up body by body afterwards: so bodies that share
// neighbours can be worked on at the same time, and every sum still has its one order.
template <class Real>
struct ContactForce {
  std::uint16_t vertex = 0;
  Face corners{};  // in the faces' body
  bool acts = false;
  Vector3<Real> onVertex;
  std::array<Vector3<Real>, 3> onCorners;
};

// forces: as many as contacts.
template <class Real>
void ComputeBodyContacts(const ContactParameters<Real>& parameters, const Meeting<Real>& meeting,
                         std::span<const BodyContact<Real>> contacts, std::span<ContactForce<Real>> forces);

// add(vertex, force)
template <class Real, class Add>
void AddToVertices(std::span<const ContactForce<Real>> contactForces, const Add& add) {
  for (const ContactForce<Real>& force : contactForces) {
    if (force.acts) add(force.vertex, force.onVertex);
  }
}
template <class Real, class Add>
void AddToCorners(std::span<const ContactForce<Real>> contactForces, const Add& add) {
  for (const ContactForce<Real>& force : contactForces) {
    for (std::size_t i = 0; force.acts && i < 3; ++i) add(force.corners[i], force.onCorners[i]);
  }
}

// After a substep of h seconds: follows faces, arms, lets sticking contacts slip as far as friction cannot hold them.
template <class Real>
void UpdateBodyContacts(const ContactParameters<Real>& parameters, const Meeting<Real>& meeting, Real h,
                        std::span<BodyContact<Real>> contacts);

// What the springs of one side hold, normal and stick, J.
template <class Real>
[[nodiscard]] double ComputeBodyContactEnergy(const ContactParameters<Real>& parameters, const Meeting<Real>& meeting,
                                              std::span<const BodyContact<Real>> contacts);

// What contacts ask of a vertex's step, as sums over them: stiffness, N/m, and damping, N·s/m.
struct VertexLoad {
  double stiffness = 0;
  double damping = 0;
};

// Adds what the contacts of one side may come to within `duration` s. With the force on p and −wᵢ times it on the
// corners, p's row of the contact's matrix has the absolute sum k (1 + Σ wᵢ) = 2k and a corner's 2 wᵢ k; the largest
// row sum over mass bounds the square of the frequency (Gershgorin). On matching meshes it is 4k/m, far more where a
// hard impact has drawn many vertices onto few faces. Returns the substeps that the fastest contact asks for.
template <class Real>
[[nodiscard]] int AddContactLoads(const ContactParameters<Real>& parameters, const Meeting<Real>& meeting,
                                  std::span<const BodyContact<Real>> contacts, double duration,
                                  std::span<VertexLoad> loads, std::span<VertexLoad> skinLoads);

}  // namespace wobble::physics
