// Contacts between bodies: vertices of one body against the faces of another. This file has a contact's state, its
// phases and its law; body_contact_search.h finds contacts at the beginning of a tick, body_contact_update.h moves them
// on after each substep.
//
// Normal force. A vertex p lies below the plane of a face (a, b, c) at depth d = −n·(p − a); its foot on the plane is
// q = Σ wᵢ xᵢ. The vertex gets N n, with N from the law in contact.h, and each corner gets −wᵢ N n. Since ∂d/∂p = −n
// and ∂d/∂xᵢ = wᵢ n exactly, this is the gradient of a potential: momentum and angular momentum are kept to rounding.
//
// Friction. A force F on p and −wᵢ F on the corners alone would leave the torque (p − q) × F = −d n × F. Normal forces
// −d (F·∇wᵢ) n on the corners, whose sum is zero, balance it, since Σ (F·∇wᵢ) xᵢ = F.
//
// Arming. A contact exerts force only after its vertex has been outside, or at most kArmingDepth deep: bodies that were
// put into one another then drift apart instead of exploding. For the same reason a contact is disarmed when it is
// suddenly deeper than motion can have brought it, as on a face that a violent impact has folded over.
//
// Facing. Where boxes lie edge on edge, the face nearest to a vertex may be one that the vertex only passes by; that
// face would push it sideways. So a contact prefers a face beside it that looks towards the vertex's own skin.
//
// Open skins have no inside. There a contact keeps to the side on which its vertex was first seen, however deep the
// vertex is behind it, until the vertex leaves past the border: a vertex crosses a thin sheet within one substep, and
// from its position alone nobody could tell on which side it belongs. Below a ridge or a tip, where no face is straight
// above it, the nearest point of the skin pulls it back, without friction (FindSeen of body_contact_view.h).
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "server/physics/contact/contact.h"
#include "server/physics/model/blueprint.h"
#include "server/physics/skins/face_search.h"

namespace wobble::physics {

// What a contact does. It "pushes" while 0 < depth <= maxDepth, the leap subtracted from the depth, and its foot lies
// within kMaxOverhang (body_contact_view.h) of the face. "Begin": at the beginning of a tick; "end": after a substep.
// A closed skin is meant where an open one is not named.
//
//   from               when                                                   to
//   (none)             begin: found at most kArmingDepth deep (1)             kArmed
//   (none)             begin: found at an open skin, at any depth             kArmed
//   (none)             begin: found deeper than kArmingDepth                  kWaiting
//   kWaiting           begin, end: at most kArmingDepth deep (1)              kArmed
//   kArmed             end: pushes (2)                                        kTouching; the stick spring begins
//   kTouching          end: does not push                                     kArmed; the stick spring ends
//   kArmed, kTouching  begin, end: deeper than maxDepth; never at open skins  kWaiting; leap and stick spring end
//   kArmed, kTouching  begin, end: leapt behind an open skin (3)              kAside; the stick spring ends
//   kAside             begin, end: not leapt behind                           kArmed; the depth becomes leap
//   any                begin: out of reach, and not behind an open skin       (none)
//
// (1) The depth beyond FindFreeDepth becomes leap. (2) A contact may be armed and touch at the end of one substep. (3)
// HasLeaptBehind of body_contact_update.cpp.
enum class ContactPhase : std::uint8_t {
  kWaiting,   // no force: the vertex has not come from outside
  kArmed,     // a force as soon as it pushes, without a stick spring
  kTouching,  // it pushed at the end of the last substep: foot and slip describe the stick spring
  kAside,     // no force: the face is of a layer that the vertex is behind without having passed it
};

[[nodiscard]] constexpr bool MayPush(ContactPhase phase) {
  return phase == ContactPhase::kArmed || phase == ContactPhase::kTouching;
}

// The side of a skin that a contact's vertex came from. A closed skin has only a front. At an open skin a new contact
// takes the side that its vertex is on, and changes it only while the vertex is past the border.
enum class SkinSide : std::uint8_t { kFront, kBack };

// One vertex near one face. Lists are sorted by vertex, one contact a vertex; all fields live on from tick to tick.
//
// The stick spring's length is `slip` plus the way that the vertex has moved since the last substep against the point
// of the skin that was then under it. An anchor fixed to the skin where the contact began would give the same length,
// but on a face that is squashed thin its barycentric weights grow without bound, and with them the force's share of
// every tremor of the corners.
template <class Real>
struct BodyContact {
  std::uint16_t vertex = 0;
  std::uint16_t face = 0;
  ContactPhase phase = ContactPhase::kWaiting;
  SkinSide side = SkinSide::kFront;
  Real maxDepth = 0;                           // that motion can bring in the next substep, m
  Real depth = 0;                              // pushed back at the end of the last substep, m; negative outside
  Real leap = 0;                               // depth beyond `depth` that no motion has brought: not pushed back, m
  Vector3<Real> foot = Vector3<Real>::Zero();  // barycentric, on `face`, under the vertex at the last substep's end
  Vector3<Real> slip = Vector3<Real>::Zero();  // of the stick spring at the last substep's end, along the face, m
  // Normal of the vertex's own skin when the tick began, unit length; zero if this skin or the other is open.
  Vector3<Real> outward = Vector3<Real>::Zero();
};

// Whether the contact's vertex is behind an open skin. Nothing but the contact knows that, so it must not be dropped,
// however far the vertex is from the skin.
template <class Real>
[[nodiscard]] bool IsBehind(const Topology& skin, const BodyContact<Real>& contact) {
  return skin.isOpen && contact.phase != ContactPhase::kWaiting && contact.depth + contact.leap > Real(0);
}

// One side of a pair at one moment: a body whose vertices are looked at, and one whose faces are.
template <class Real>
struct Meeting {
  VectorView<Real> x;            // of the vertices' body, in its own local coordinates, m
  VectorView<Real> v;            // m/s
  std::span<const Real> shares;  // Coefficients::contactShares of the same body
  Skin<Real> skin;               // of the faces' body, in that body's local coordinates
  VectorView<Real> skinV;
  Vector3<Real> shift = Vector3<Real>::Zero();  // from the vertices' coordinates to the faces', m
};

// The parameters of two materials against one another: springs and dashpots in series (two equal ones stay as they
// are), the mean of the fade depths, the geometric mean of the frictions. Fields of other laws stay at their defaults.
template <class Real>
[[nodiscard]] ContactParameters<Real> Combine(const ContactParameters<Real>& a, const ContactParameters<Real>& b);

// The depth that a contact may begin with, m, at most kArmingDepth. Such depth brings in the energy of a spring that
// nobody pressed, the more the stiffer the spring is; so the depth falls with stickDamping/stickStiffness, which goes
// with the time that the contact's vertex takes to swing.
template <class Real>
[[nodiscard]] Real FindFreeDepth(const ContactParameters<Real>& parameters);

// The force of one contact, N. Forces of all contacts are computed first and added up body by body afterwards: so
// bodies that share neighbours can be worked on at the same time, and every sum still has its one order.
template <class Real>
struct ContactForce {
  std::uint16_t vertex = 0;
  Face corners{};     // in the faces' body
  bool acts = false;  // false: the other fields are not set
  Vector3<Real> onVertex;
  std::array<Vector3<Real>, 3> onCorners;
};

// Writes one force per contact. forces: as many as contacts. Within a substep a contact stays on its face or goes to
// the one beside it, so that the force is nearly always a smooth function of the stages' positions.
template <class Real>
void ComputeBodyContacts(const ContactParameters<Real>& parameters, const Meeting<Real>& meeting,
                         std::span<const BodyContact<Real>> contacts, std::span<ContactForce<Real>> forces);

// Calls add(vertex, force) for each force on a vertex, in the order of the contacts.
template <class Real, class Add>
void AddToVertices(std::span<const ContactForce<Real>> contactForces, const Add& add) {
  for (const ContactForce<Real>& force : contactForces) {
    if (force.acts) add(force.vertex, force.onVertex);
  }
}
// The same for the corners of the faces, three calls a contact.
template <class Real, class Add>
void AddToCorners(std::span<const ContactForce<Real>> contactForces, const Add& add) {
  for (const ContactForce<Real>& force : contactForces) {
    for (std::size_t i = 0; force.acts && i < 3; ++i) add(force.corners[i], force.onCorners[i]);
  }
}

// The energy that the springs of one side hold, normal and stick, J.
template <class Real>
[[nodiscard]] double ComputeBodyContactEnergy(const ContactParameters<Real>& parameters, const Meeting<Real>& meeting,
                                              std::span<const BodyContact<Real>> contacts);

// What contacts ask of a vertex's step, as sums over them: stiffness, N/m, and damping, N·s/m.
struct VertexLoad {
  double stiffness = 0;
  double damping = 0;
};

// Adds the loads that the contacts of one side may come to within `duration` s to `loads`, by vertex, and `skinLoads`,
// by vertex of the faces' body. With the force on p and −wᵢ times it on the corners, p's row of the contact's matrix
// has the absolute sum k (1 + Σ wᵢ) = 2k and a corner's 2 wᵢ k; the largest row sum over mass bounds the square of the
// frequency (Gershgorin). On matching meshes it is 4k/m, far more where a hard impact has drawn many vertices onto few
// faces. Returns the substeps that the fastest contact asks for, at least 1.
template <class Real>
[[nodiscard]] int AddContactLoads(const ContactParameters<Real>& parameters, const Meeting<Real>& meeting,
                                  std::span<const BodyContact<Real>> contacts, double duration,
                                  std::span<VertexLoad> loads, std::span<VertexLoad> skinLoads);

}  // namespace wobble::physics
