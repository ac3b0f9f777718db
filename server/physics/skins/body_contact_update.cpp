// Faces are searched for once a tick and followed after each substep: a point inside keeps the face that it came in
// through and slides from face to face, a point outside belongs to the nearest one (face_search.h). In an island the
// lanes do the same for contacts that stay on their face (kernels/contact/body_contact_kernel.h).
#include "server/physics/skins/body_contact_update.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "server/physics/kernels/contact/contact_limits.h"
#include "server/physics/skins/body_contact_view.h"

namespace wobble::physics {
namespace {

// The barycentric weight by which a vertex may seem to have slid since the last substep when nothing but the origins of
// coordinates has moved.
constexpr double kStandingOverhang = 1e-3;

// Whether the vertex is above the face and within the gap. It changes its face as one inside does: over a valley the
// nearest face would be one and then the other, and its push would turn each time.
template <class Real>
bool IsInGap(const Skin<Real>& skin, const FacePoint<Real>& at) {
  return (skin.topology->isOpen || skin.fadingGap > Real(0)) && at.distance < Real(0);
}

// The face that a contact has come to. Changes contact.side if the vertex has passed the border of an open skin.
// before: p seen from the contact's face, on its side.
template <class Real>
FacePoint<Real> FindPresentFace(const Meeting<Real>& meeting, const Vector3<Real>& p, const FacePoint<Real>& before,
                                BodyContact<Real>& contact) {
  const Skin<Real> skin = SkinFrom(meeting, contact.side);
  const bool isOpen = skin.topology->isOpen;
  if (contact.phase != ContactPhase::kWaiting) {
    const FacePoint<Real> at = SlideToFace(skin, before, p);
    if (LooksAlong(at, contact.outward) && HangsOn(contact, at, before)) return before;
    if (IsInside(skin, at) || IsInGap(skin, at)) {
      if (!isOpen) return TurnToFacing(skin, at, p, contact.outward, static_cast<Real>(kArmingDepth));
      if (at.weights.minCoeff() >= Real(0)) return at;
    }
  }
  const FacePoint<Real> at = FindNearestFace(skin, before, p);
  if (!isOpen) return TurnToFacing(skin, at, p, contact.outward, static_cast<Real>(kArmingDepth));
  if (!IsInside(skin, at) || !IsPastBorder(skin, at)) return at;
  if (contact.phase != ContactPhase::kWaiting && FindSeen(skin, contact, at, p).rounded) return at;
  const Skin<Real> front = SkinFrom(meeting, SkinSide::kFront);
  const FacePoint<Real> there = FindNearestFace(front, FindFacePoint(front, at.face, p), p);
  return ChooseSide(meeting, there, p, contact.outward, contact.side);
}

// Whether the vertex, which was in the gap above a face of an open skin, has come to another over a sharp edge. In a
// valley it is in the gaps of both, but is pushed out of one alone, until it has slid over the edge. What it is deep in
// the other gap then, nothing has pressed. Up to Skin::offset of leap lets no vertex through: the depth below the plane
// remains. Over a smooth edge that depth is small, and as leap it cost more accuracy than it saved energy: a ball on a
// cloth was off by 21 mm instead of 3.
template <class Real>
bool HasCrossedValley(const Skin<Real>& skin, const BodyContact<Real>& contact, const FacePoint<Real>& before,
                      const FacePoint<Real>& at) {
  return MayPush(contact.phase) && at.face != contact.face && !at.rounded &&
         before.normal.dot(at.normal) < static_cast<Real>(kSmoothCosine) && contact.depth + contact.leap < skin.offset;
}

// Updates contact.leap, the depth that no motion has brought, for a contact that went from `before` to `at` in h s.
//
// When a fold brings another face before a vertex, or a face that did not lie above the vertex begins to, the depth
// leaps. A force that leapt with it would bring in the energy of a spring that nobody pressed, again at every change: a
// ball caught by a rubber sheet was thrown out faster than it had come. So the leap is subtracted from the depth, and
// it shrinks as the vertex comes out.
//
// In a closed body, all depth that the approach cannot have brought is leap. An open skin has nothing behind its faces
// that could catch the vertex later. There the depth goes over steadily from face to face (FindSeen), and a contact
// that touches takes on no leap: with one, balls and pairs sank through at every ridge that they were pressed against.
// One that begins does, of the depth that no motion in any direction could have brought, and so does one that has
// crossed a valley.
template <class Real>
void NoteLeap(const ContactParameters<Real>& parameters, const Meeting<Real>& meeting, const FacePoint<Real>& before,
              const FacePoint<Real>& at, Real h, BodyContact<Real>& contact) {
  const Real depth = -at.distance;
  const Vector3<Real> velocity = FindRelativeVelocity(meeting, contact.vertex, at);
  Real most = contact.depth;
  Real room = std::numeric_limits<Real>::max();  // for more leap
  if (meeting.skin.topology->isOpen) {
    if (HasCrossedValley(meeting.skin, contact, before, at)) {
      room = std::max(Real(0), meeting.skin.offset - contact.leap);
    } else {
      if (contact.phase == ContactPhase::kTouching) most = depth;
      if (contact.phase != ContactPhase::kAside) most += static_cast<Real>(kArmingDepth);
    }
    most += static_cast<Real>(kArmingSteps) * h * std::sqrt(velocity.dot(velocity));
  } else {
    most +=
        FindFreeDepth(parameters) + static_cast<Real>(kArmingSteps) * h * std::max(Real(0), -at.normal.dot(velocity));
  }
  contact.leap += std::clamp(depth - contact.leap - most, Real(0), room);
  contact.leap = std::clamp(contact.leap, Real(0), std::max(Real(0), depth));
}

// Whether the vertex was in front of the open skin and is behind it, seen from `at`, though nothing can have brought it
// there in h s. The walk from face to face has then ended at a layer of a crumpled skin that another one lies before,
// or that is turned over. Taken for the vertex's place, all its depth would be leap, and when the vertex came to the
// skin for true, it would be behind already and go on through. A plane that goes on from substep to substep moves no
// farther than the vertex against it; one that takes over from another may lie up to kArmingDepth elsewhere.
template <class Real>
bool HasLeaptBehind(const Meeting<Real>& meeting, const BodyContact<Real>& contact, const FacePoint<Real>& at, Real h) {
  const Skin<Real>& skin = meeting.skin;
  if (!skin.topology->isOpen || at.rounded || !IsInside(skin, at)) return false;
  const Real before = contact.depth + contact.leap - skin.offset;
  if (before > Real(0)) return false;
  const Vector3<Real> velocity = FindRelativeVelocity(meeting, contact.vertex, at);
  Real play = contact.maxDepth - std::max(Real(0), contact.depth) +
              static_cast<Real>(kArmingSteps) * h * std::sqrt(velocity.dot(velocity));
  if (contact.phase == ContactPhase::kAside && at.face == contact.face) play -= static_cast<Real>(kArmingDepth);
  return -at.distance - skin.offset - before > play;
}

// Whether and how deep the vertex is pushed, which has come from the face `before` to `at` after h s: returns `at` with
// the leap, brought up to date, added to its distance. A vertex aside is seen from the nearest point of the layer, in
// front of which it counts, and all its depth is leap. Rejected: to let it be pushed once it is as near as it may have
// come through. That was a spring of up to 2 Skin::offset that nobody pressed, and threw graphs and open meshes out of
// one another. And to change its side: of 400 shots at sheets 12 hung and 2 went through.
template <class Real>
FacePoint<Real> FindPushed(const ContactParameters<Real>& parameters, const Meeting<Real>& meeting,
                           const FacePoint<Real>& before, const FacePoint<Real>& at, const Vector3<Real>& p, Real h,
                           BodyContact<Real>& contact) {
  FacePoint<Real> seen = at;
  if (HasLeaptBehind(meeting, contact, at, h)) {
    seen = FindRounded(SkinFrom(meeting, contact.side), at, p, false);
    contact.phase = ContactPhase::kAside;
    contact.leap = std::max(Real(0), -seen.distance);
  } else {
    NoteLeap(parameters, meeting, before, at, h, contact);
    if (contact.phase == ContactPhase::kAside) contact.phase = ContactPhase::kArmed;
  }
  seen.distance += contact.leap;
  return seen;
}

// The vertex of a new contact, in front of the open skin. Where the nearest face's plane has it behind, it is seen from
// the nearest point.
template <class Real>
FacePoint<Real> SeeFirst(const Skin<Real>& skin, const FacePoint<Real>& at, const Vector3<Real>& p) {
  return IsInside(skin, at) ? FindRounded(skin, at, p, false) : at;
}

// FindPresentFace after a substep of h s, with the leap brought up to date and added to the distance that is returned.
// before: as there.
template <class Real>
FacePoint<Real> RenewContact(const ContactParameters<Real>& parameters, const Meeting<Real>& meeting,
                             const Vector3<Real>& p, const FacePoint<Real>& before, Real h,
                             BodyContact<Real>& contact) {
  const SkinSide sideBefore = contact.side;
  FacePoint<Real> at = FindPresentFace(meeting, p, before, contact);
  if (contact.phase == ContactPhase::kWaiting) {
    contact.leap = 0;
    FadeGap(meeting.skin, at);
    return at;
  }
  const Skin<Real> skin = SkinFrom(meeting, contact.side);
  at = FindSeen(skin, contact, at, p);
  FadeGap(skin, at);
  if (contact.side == sideBefore) return FindPushed(parameters, meeting, before, at, p, h, contact);
  // The depth is the same from both sides: the skin's points lie in the middle of Skin::offset.
  contact.leap = std::clamp(contact.leap, Real(0), std::max(Real(0), -at.distance));
  if (contact.phase == ContactPhase::kAside) contact.phase = ContactPhase::kArmed;
  at.distance += contact.leap;
  return at;
}

}  // namespace

template <class Real>
FacePoint<Real> ChooseSide(const Meeting<Real>& meeting, const FacePoint<Real>& front, const Vector3<Real>& p,
                           const Vector3<Real>& outward, SkinSide& side) {
  side = SkinSide::kFront;
  const Skin<Real> skin = SkinFrom(meeting, side);
  if (!skin.topology->isOpen) return TurnToFacing(skin, front, p, outward, static_cast<Real>(kArmingDepth));
  if (!IsBehindSkin(skin, front, p)) return SeeFirst(skin, front, p);
  side = SkinSide::kBack;
  const Skin<Real> back = SkinFrom(meeting, side);
  return SeeFirst(back, FindNearestFace(back, FindFacePoint(back, front.face, p), p), p);
}

template <class Real>
void Arm(const ContactParameters<Real>& parameters, const Vector3<Real>& velocity, Real h, const Skin<Real>& skin,
         FacePoint<Real>& at, BodyContact<Real>& contact) {
  Real depth = std::max(Real(0), -at.distance);
  const Real play =
      static_cast<Real>(kArmingDepth) + static_cast<Real>(kArmingSteps) * h * std::sqrt(velocity.dot(velocity));
  const bool wasWaiting = contact.phase == ContactPhase::kWaiting;
  const bool isOpen = skin.topology->isOpen;
  if (!isOpen && !(depth <= (wasWaiting ? static_cast<Real>(kArmingDepth) + skin.offset : contact.maxDepth))) {
    contact.phase = ContactPhase::kWaiting;
  } else if (wasWaiting) {
    contact.phase = ContactPhase::kArmed;
    if (!isOpen) {
      // Above the face nothing is pressed yet.
      const Real below = std::max(Real(0), depth - skin.offset);
      contact.leap = depth - std::min(below, FindFreeDepth(parameters));
      at.distance += contact.leap;
      depth -= contact.leap;
    }
  }
  contact.maxDepth = depth + play;
}

template <class Real>
FacePoint<Real> RecallContact(const ContactParameters<Real>& parameters, const Meeting<Real>& meeting,
                              const Vector3<Real>& p, BodyContact<Real>& contact) {
  FacePoint<Real> at = FindFacePoint(SkinFrom(meeting, contact.side), contact.face, p);
  const bool stands = (at.weights - contact.foot).cwiseAbs().maxCoeff() < static_cast<Real>(kStandingOverhang) &&
                      at.weights.minCoeff() >= Real(0);
  if (!stands || contact.phase == ContactPhase::kWaiting || LooksAlong(at, contact.outward)) {
    return RenewContact(parameters, meeting, p, at, Real(0), contact);
  }
  return FindPushed(parameters, meeting, at, at, p, Real(0), contact);
}

template <class Real>
void UpdateBodyContacts(const ContactParameters<Real>& parameters, const Meeting<Real>& meeting, Real h,
                        std::span<BodyContact<Real>> contacts) {
  for (BodyContact<Real>& contact : contacts) {
    const Vector3<Real> p = meeting.x[contact.vertex] + meeting.shift;
    const bool wasTouching = contact.phase == ContactPhase::kTouching;
    const FacePoint<Real> before = FindFacePoint(SkinFrom(meeting, contact.side), contact.face, p);
    FacePoint<Real> at = RenewContact(parameters, meeting, p, before, h, contact);
    const Vector3<Real> velocity = FindRelativeVelocity(meeting, contact.vertex, at);
    Arm<Real>(parameters, velocity, h, meeting.skin, at, contact);
    const Real depth = -at.distance;
    Vector3<Real> slip = wasTouching ? FindSlip(meeting, contact, p, at)
                                     : FindFirstSlip<Real>(h, std::max(Real(0), depth), at.normal, velocity);
    const Real limit = at.rounded ? Real(0) : parameters.friction * ComputePenalty(parameters, depth);
    const Real strength = parameters.stickStiffness * std::sqrt(slip.dot(slip));
    if (strength > limit) slip *= limit / strength;
    const bool pushes = Pushes(contact, at);
    if (MayPush(contact.phase)) contact.phase = pushes ? ContactPhase::kTouching : ContactPhase::kArmed;
    // A vertex that hangs past a border may come in from beside at any depth, which then nobody has pressed.
    if (!pushes && depth > Real(0) && meeting.skin.topology->isOpen) contact.leap += depth;
    contact.depth = pushes ? depth : std::min(depth, Real(0));
    contact.face = at.face;
    contact.foot = at.weights;
    contact.slip = slip;
  }
}

#define WOBBLE_INSTANTIATE(Real)                                                                                \
  template void UpdateBodyContacts<Real>(const ContactParameters<Real>&, const Meeting<Real>&, Real,            \
                                         std::span<BodyContact<Real>>);                                         \
  template FacePoint<Real> RecallContact<Real>(const ContactParameters<Real>&, const Meeting<Real>&,            \
                                               const Vector3<Real>&, BodyContact<Real>&);                       \
  template FacePoint<Real> ChooseSide<Real>(const Meeting<Real>&, const FacePoint<Real>&, const Vector3<Real>&, \
                                            const Vector3<Real>&, SkinSide&);                                   \
  template void Arm<Real>(const ContactParameters<Real>&, const Vector3<Real>&, Real, const Skin<Real>&,        \
                          FacePoint<Real>&, BodyContact<Real>&);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
