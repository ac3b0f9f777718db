// Moves body contacts on in time: which face and side a contact belongs to, its phase, its leap, its stick spring.
#pragma once

#include <span>

#include "server/physics/skins/body_contact.h"

namespace wobble::physics {

// After a substep of h seconds, for one side of a pair: each contact follows its face, changes its phase, and lets its
// stick spring slip as far as friction cannot hold it.
template <class Real>
void UpdateBodyContacts(const ContactParameters<Real>& parameters, const Meeting<Real>& meeting, Real h,
                        std::span<BodyContact<Real>> contacts);

// The steps below are shared with the search at the beginning of a tick. p: the vertex, in the faces' coordinates, m.

// Finds the face of a contact that lives on from the last tick; changes its side and leap. The distance that is
// returned has the leap added.
template <class Real>
[[nodiscard]] FacePoint<Real> RecallContact(const ContactParameters<Real>& parameters, const Meeting<Real>& meeting,
                                            const Vector3<Real>& p, BodyContact<Real>& contact);

// The nearest face from the side that p is on, and that side. front: the nearest face from the front.
template <class Real>
[[nodiscard]] FacePoint<Real> ChooseSide(const Meeting<Real>& meeting, const FacePoint<Real>& front,
                                         const Vector3<Real>& p, const Vector3<Real>& outward, SkinSide& side);

// Arms or disarms a contact that is at `at` and sets how deep it may come in the next h seconds at this velocity
// against the face, m/s. A contact that is armed inside of a closed body leaps: its distance grows by that.
template <class Real>
void Arm(const ContactParameters<Real>& parameters, const Vector3<Real>& velocity, Real h, const Skin<Real>& skin,
         FacePoint<Real>& at, BodyContact<Real>& contact);

}  // namespace wobble::physics
