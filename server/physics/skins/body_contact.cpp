// The plain law of body contacts: forces, energy, and what contacts ask of the step. In an island the lanes compute the
// forces (kernels/contact/body_contact_kernel.h) and leave one contact in a hundred to this code.
#include "server/physics/skins/body_contact.h"

#include <algorithm>
#include <cmath>

#include "server/physics/kernels/contact/contact_limits.h"
#include "server/physics/skins/body_contact_view.h"

namespace wobble::physics {
namespace {

// The speed at which a contact that begins at kArmingDepth may throw out its vertex, m/s. Bodies of 12 vertices that
// met edge on edge were torn apart by a centimetre of springs that are stiff for their mass.
constexpr double kFreeSpeed = 2.5;
// A contact whose vertex comes nearer by more than this in a tick, m, needs kFastSubsteps; with fewer the vertex may
// have passed the far side before it is pushed back.
constexpr double kFastWay = 0.1;
constexpr int kFastSubsteps = 4;

// The face that a contact belongs to within a substep: its own or the one beside it.
template <class Real>
FacePoint<Real> FollowContact(const Skin<Real>& skin, const BodyContact<Real>& contact, const Vector3<Real>& p) {
  const FacePoint<Real> at = FollowFace(skin, contact.face, p);
  if (at.face == contact.face) return at;
  const FacePoint<Real> kept = FindFacePoint(skin, contact.face, p);
  return HangsOn(contact, at, kept) ? kept : at;
}

// Where the contact's vertex is to that face, with the leap added to the distance.
template <class Real>
FacePoint<Real> FindStagePoint(const Meeting<Real>& meeting, const Vector3<Real>& p, const BodyContact<Real>& contact) {
  const Skin<Real> skin = SkinFrom(meeting, contact.side);
  FacePoint<Real> at = FindSeen(skin, contact, FollowContact(skin, contact, p), p);
  FadeGap(skin, at);
  at.distance += contact.leap;
  return at;
}

}  // namespace

template <class Real>
ContactParameters<Real> Combine(const ContactParameters<Real>& a, const ContactParameters<Real>& b) {
  const auto inSeries = [](Real one, Real other) {
    return one + other > Real(0) ? Real(2) * one * other / (one + other) : Real(0);
  };
  ContactParameters<Real> both;
  both.stiffness = inSeries(a.stiffness, b.stiffness);
  both.fadeDepth = (a.fadeDepth + b.fadeDepth) / Real(2);
  both.damping = inSeries(a.damping, b.damping);
  both.stickStiffness = inSeries(a.stickStiffness, b.stickStiffness);
  both.stickDamping = inSeries(a.stickDamping, b.stickDamping);
  both.friction = std::sqrt(a.friction * b.friction);
  return both;
}

template <class Real>
Real FindFreeDepth(const ContactParameters<Real>& parameters) {
  const auto most = static_cast<Real>(kArmingDepth);
  if (!(parameters.stickStiffness > Real(0))) return most;
  return std::min(most, static_cast<Real>(kFreeSpeed) * parameters.stickDamping / parameters.stickStiffness);
}

template <class Real>
void ComputeBodyContacts(const ContactParameters<Real>& parameters, const Meeting<Real>& meeting,
                         std::span<const BodyContact<Real>> contacts, std::span<ContactForce<Real>> forces) {
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const BodyContact<Real>& contact = contacts[c];
    ContactForce<Real>& result = forces[c];
    result.acts = false;
    if (contact.phase == ContactPhase::kWaiting) continue;
    const Vector3<Real> p = meeting.x[contact.vertex] + meeting.shift;
    const FacePoint<Real> at = FindStagePoint(meeting, p, contact);
    if (!Pushes(contact, at)) continue;
    const Real depth = -at.distance;
    const Face& face = meeting.skin.faces[at.face];
    const Vector3<Real> velocity = FindRelativeVelocity(meeting, contact.vertex, at);
    const Real rate = -at.normal.dot(velocity);
    const Real normalForce = ComputeNormalForce(parameters, depth, rate);
    Vector3<Real> pull = parameters.stickDamping * RemoveNormalPart<Real>(velocity, at.normal);
    if (contact.phase == ContactPhase::kTouching) {
      pull += FindStickPull<Real>(parameters, parameters.friction, depth, FindSlip(meeting, contact, p, at));
    }
    const Real limit = at.rounded ? Real(0) : parameters.friction * normalForce;
    const Real strength = std::sqrt(pull.dot(pull));
    if (strength > limit) pull *= limit / strength;

    const Real share = meeting.shares[contact.vertex];
    const Vector3<Real> force = share * (normalForce * at.normal - pull);
    result.acts = true;
    result.vertex = contact.vertex;
    result.corners = face;
    result.onVertex = force;
    // ∇wᵢ = n × (side opposite to corner i) / 2A, so −d (F·∇wᵢ) with F = −pull is d pull·(n × side)/2A.
    // On a face that is lower than the contact is deep they would exceed the friction itself and ring with the thin
    // triangle; there part of the torque is given up.
    std::array<Vector3<Real>, 3> sides;
    for (std::size_t i = 0; i < 3; ++i)
      sides[i] = meeting.skin.x[face[(i + 2) % 3]] - meeting.skin.x[face[(i + 1) % 3]];
    const Real longest = std::sqrt(std::max({sides[0].squaredNorm(), sides[1].squaredNorm(), sides[2].squaredNorm()}));
    const Real below = depth + contact.leap + at.faded - meeting.skin.offset;  // the face itself, m
    const Real lever = std::clamp(below / at.doubleArea, Real(-1) / longest, Real(1) / longest);
    const Real winding =
        contact.side == SkinSide::kBack ? Real(-1) : Real(1);  // from behind, the sides go round the other way
    const Vector3<Real> turned = pull.cross(at.normal) * (winding * share * lever);
    for (std::size_t i = 0; i < 3; ++i) {
      result.onCorners[i] = turned.dot(sides[i]) * at.normal - at.weights[static_cast<Eigen::Index>(i)] * force;
    }
  }
}

template <class Real>
double ComputeBodyContactEnergy(const ContactParameters<Real>& parameters, const Meeting<Real>& meeting,
                                std::span<const BodyContact<Real>> contacts) {
  double energy = 0;
  for (const BodyContact<Real>& contact : contacts) {
    const Vector3<Real> p = meeting.x[contact.vertex] + meeting.shift;
    const FacePoint<Real> at = FindStagePoint(meeting, p, contact);
    if (!Pushes(contact, at)) continue;
    Real stored = ComputePenaltyEnergy(parameters, -at.distance);
    if (contact.phase == ContactPhase::kTouching && !at.rounded) {
      const Vector3<Real> slip = FindSlip(meeting, contact, p, at);
      stored += parameters.stickStiffness * slip.dot(slip) / Real(2);
    }
    energy += double{meeting.shares[contact.vertex] * stored};
  }
  return energy;
}

template <class Real>
int AddContactLoads(const ContactParameters<Real>& parameters, const Meeting<Real>& meeting,
                    std::span<const BodyContact<Real>> contacts, double duration, std::span<VertexLoad> loads,
                    std::span<VertexLoad> skinLoads) {
  int substeps = 1;
  for (const BodyContact<Real>& contact : contacts) {
    if (contact.phase == ContactPhase::kWaiting) continue;
    const Vector3<Real> p = meeting.x[contact.vertex] + meeting.shift;
    const Skin<Real> skin = SkinFrom(meeting, contact.side);
    const FacePoint<Real> at = FindSeen(skin, contact, FindFacePoint<Real>(skin, contact.face, p), p);
    const double approach = -double{at.normal.dot(FindRelativeVelocity(meeting, contact.vertex, at))};
    const double depth = PredictDepth(-double{at.distance}, approach, duration);
    if (depth <= 0) continue;
    const auto reached = static_cast<Real>(depth);
    const Real ofAll = meeting.shares[contact.vertex];
    const Real stiffness = std::max(ComputePenaltySlope(parameters, reached), parameters.stickStiffness);
    const Real damping =
        std::max(parameters.damping * ComputeDampingShare(parameters, reached), parameters.stickDamping);
    const auto add = [&](VertexLoad& load, Real weight) {
      load.stiffness += 2 * double{ofAll * weight * stiffness};
      load.damping += 2 * double{ofAll * weight * damping};
    };
    add(loads[contact.vertex], Real(1));
    const Face& face = meeting.skin.faces[contact.face];
    for (std::size_t i = 0; i < 3; ++i) {
      add(skinLoads[face[i]], std::clamp(at.weights[static_cast<Eigen::Index>(i)], Real(0), Real(1)));
    }
    if (approach * duration > kFastWay) substeps = kFastSubsteps;
  }
  return substeps;
}

#define WOBBLE_INSTANTIATE(Real)                                                                                  \
  template ContactParameters<Real> Combine<Real>(const ContactParameters<Real>&, const ContactParameters<Real>&); \
  template Real FindFreeDepth<Real>(const ContactParameters<Real>&);                                              \
  template void ComputeBodyContacts<Real>(const ContactParameters<Real>&, const Meeting<Real>&,                   \
                                          std::span<const BodyContact<Real>>, std::span<ContactForce<Real>>);     \
  template double ComputeBodyContactEnergy<Real>(const ContactParameters<Real>&, const Meeting<Real>&,            \
                                                 std::span<const BodyContact<Real>>);                             \
  template int AddContactLoads<Real>(const ContactParameters<Real>&, const Meeting<Real>&,                        \
                                     std::span<const BodyContact<Real>>, double, std::span<VertexLoad>,           \
                                     std::span<VertexLoad>);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
