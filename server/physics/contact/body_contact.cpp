// Faces are looked for once a tick and followed after each substep; within one a contact keeps to its face or the one
// beside it, so that the force is a smooth function of the stages' positions nearly always.
#include "server/physics/contact/body_contact.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "server/physics/lanes/contact_limits.h"

namespace wobble::physics {
namespace {

// Speed at which a beginning at kArmingDepth may throw out its vertex, m/s. Bodies of 12 vertices that met edge on edge
// were torn apart by a centimetre of springs that are stiff for their mass.
constexpr double kFreeSpeed = 2.5;
// How far, in barycentric weight, a vertex may have slid beyond its face within a substep and still be pushed by it. A
// face that is squashed thin turns so fast that its plane can sweep over a vertex far beside it, whose weights are then
// a lever that makes any force as large as one likes.
constexpr double kMaxOverhang = 0.25;
// How far beyond a sharp edge, in the same weights, it may have come and still belong to its face.
constexpr double kHangingOverhang = 0.05;
// How far, in the same weights, a vertex may seem to have slid since the last substep when nothing but the origins of
// coordinates has moved.
constexpr double kStandingOverhang = 1e-3;
// Substeps that a new contact is taken to have when it is found, before their number is known.
constexpr double kLikelySubsteps = 4;
// A contact whose vertex comes nearer by more than this in a tick, m, needs kFastSubsteps, or the vertex may have
// passed the far side before it is pushed back.
constexpr double kFastWay = 0.1;
constexpr int kFastSubsteps = 4;

template <class Real>
Vector3<Real> Blend(const Vector3<Real>& weights, const Face& face, std::span<const Vector3<Real>> values) {
  return weights[0] * values[face[0]] + weights[1] * values[face[1]] + weights[2] * values[face[2]];
}

// The surface as the contact's vertex has it before itself.
template <class Real>
Skin<Real> FaceSkin(const Meeting<Real>& meeting, bool behind) {
  Skin<Real> skin = meeting.skin;
  skin.side = behind ? Real(-1) : Real(1);
  return skin;
}

// Of the vertex against the surface under it, or where that ends the nearest part of the face.
template <class Real>
Vector3<Real> FindRelativeVelocity(const Meeting<Real>& meeting, std::uint16_t vertex, const FacePoint<Real>& at) {
  const Vector3<Real> weights = at.weights.cwiseMax(Real(0));
  return meeting.v[vertex] - Blend<Real>(weights / weights.sum(), meeting.skin.faces[at.face], meeting.skinV);
}

// Deep enough to push, no deeper than it can have come, and with a face above it.
template <class Real>
bool Pushes(const BodyContact<Real>& contact, const FacePoint<Real>& at) {
  return contact.armed && at.distance < Real(0) && -at.distance <= contact.maxDepth &&
         at.weights.minCoeff() >= -static_cast<Real>(kMaxOverhang);
}

// Of the faces round the vertex the first that has p above or below itself, or the one that comes nearest to that: a
// place to begin the search from, and nearly always where it ends.
template <class Real>
std::uint16_t FindStart(const Skin<Real>& skin, std::uint16_t vertex, const Vector3<Real>& p) {
  std::uint16_t start = kNoFace;
  Real greatest = std::numeric_limits<Real>::lowest();
  for (const std::uint16_t face : skin.topology->RingOf(vertex)) {
    const Real least = FindFacePoint(skin, face, p).weights.minCoeff();
    if (start == kNoFace || least > greatest) {
      greatest = least;
      start = face;
    }
    if (least >= Real(0)) break;
  }
  return start;
}

// Arms a contact that has just begun, disarms one that has leapt, and says how deep it may come from here. One that
// begins inside of a closed body has leapt there, but for what is free.
template <class Real>
void Arm(const ContactParameters<Real>& parameters, const Vector3<Real>& velocity, Real h, bool isOpen,
         FacePoint<Real>& at, BodyContact<Real>& contact) {
  Real depth = std::max(Real(0), -at.distance);
  const Real play =
      static_cast<Real>(kArmingDepth) + static_cast<Real>(kArmingSteps) * h * std::sqrt(velocity.dot(velocity));
  const bool wasArmed = contact.armed;
  contact.armed = isOpen || depth <= (wasArmed ? contact.maxDepth : static_cast<Real>(kArmingDepth));
  if (contact.armed && !wasArmed && !isOpen) {
    contact.leap = std::max(Real(0), depth - FindFreeDepth(parameters));
    at.distance += contact.leap;
    depth -= contact.leap;
  }
  contact.maxDepth = depth + play;
}

// Whether the foot lies past a border of the surface.
template <class Real>
bool IsPastBorder(const Topology& topology, const FacePoint<Real>& at) {
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const bool beyond = at.weights[static_cast<Eigen::Index>(corner)] < Real(0);
    if (beyond && topology.neighbours[at.face][corner] == kNoFace) return true;
  }
  return false;
}

// The nearest face from the side that p is on. front: the nearest from before the surface.
template <class Real>
FacePoint<Real> ChooseSide(const Meeting<Real>& meeting, const FacePoint<Real>& front, const Vector3<Real>& p,
                           const Vector3<Real>& outward, bool& behind) {
  behind = false;
  const Skin<Real> skin = FaceSkin(meeting, behind);
  if (!skin.topology->isOpen) return TurnToFacing(skin, front, p, outward, static_cast<Real>(kArmingDepth));
  if (front.distance >= Real(0)) return front;
  behind = true;
  return FindNearestFace(FaceSkin(meeting, behind), front.face, p);
}

// Whether the vertex still hangs on to the face that it has slid over the side of, to one that it cannot have come in
// through. Where edges lie on edges, a hair decides which side of them a vertex is on, and to change the face with it
// would push sideways now and then, or drop the contact and with it what friction holds.
template <class Real>
bool HangsOn(const BodyContact<Real>& contact, const FacePoint<Real>& slid, const FacePoint<Real>& kept) {
  return LooksAlong(slid, contact.outward) && !LooksAlong(kept, contact.outward) && kept.distance < Real(0) &&
         kept.weights.minCoeff() >= -static_cast<Real>(kHangingOverhang);
}

// Within a step.
template <class Real>
FacePoint<Real> FollowContact(const Skin<Real>& skin, const BodyContact<Real>& contact, const Vector3<Real>& p) {
  const FacePoint<Real> at = FollowFace(skin, contact.face, p);
  if (at.face == contact.face) return at;
  const FacePoint<Real> kept = FindFacePoint(skin, contact.face, p);
  return HangsOn(contact, at, kept) ? kept : at;
}

// The face that a known contact has come to, and on an open surface the side.
template <class Real>
FacePoint<Real> FindPresentFace(const Meeting<Real>& meeting, const Vector3<Real>& p, BodyContact<Real>& contact) {
  const Skin<Real> skin = FaceSkin(meeting, contact.behind);
  const bool isOpen = skin.topology->isOpen;
  if (contact.armed) {
    const FacePoint<Real> at = SlideToFace(skin, contact.face, p);
    if (LooksAlong(at, contact.outward)) {
      const FacePoint<Real> kept = FindFacePoint(skin, contact.face, p);
      if (HangsOn(contact, at, kept)) return kept;
    }
    if (at.distance < Real(0)) {
      if (!isOpen) return TurnToFacing(skin, at, p, contact.outward, static_cast<Real>(kArmingDepth));
      if (!IsPastBorder(*skin.topology, at)) return at;
    }
  }
  const FacePoint<Real> at = FindNearestFace(skin, contact.face, p);
  if (!isOpen) return TurnToFacing(skin, at, p, contact.outward, static_cast<Real>(kArmingDepth));
  if (at.distance >= Real(0) || !IsPastBorder(*skin.topology, at)) return at;
  const FacePoint<Real> front = FindNearestFace(FaceSkin(meeting, false), at.face, p);
  return ChooseSide(meeting, front, p, contact.outward, contact.behind);
}

// Where a fold brings another face before a vertex, or one that did not lie above it begins to, the depth leaps. A
// force that leapt with it would bring in the energy of a spring that nobody pressed, again at every change: a ball
// caught by a rubber sheet was thrown out faster than it had come. So depth that has leapt is none: only what the
// vertex goes beyond it is pushed back, and it is forgotten as the vertex comes out.
//
// In a closed body all that motion cannot have brought has leapt. An open one has nothing behind its faces that could
// catch the vertex later, so there a change of face counts, and beside it only what no motion in any direction could
// have brought: with the rule for closed ones balls sank through. A planar body that is squashed turns faces over in
// its own plane; what stood half a metre before such a face is then half a metre behind it.
template <class Real>
void NoteLeap(const ContactParameters<Real>& parameters, const Meeting<Real>& meeting, const FacePoint<Real>& before,
              const FacePoint<Real>& at, Real h, BodyContact<Real>& contact) {
  const Real depth = -at.distance;
  const Vector3<Real> velocity = FindRelativeVelocity(meeting, contact.vertex, at);
  Real most = contact.depth;
  if (meeting.skin.topology->isOpen) {
    if (at.face != before.face) contact.leap += before.distance - at.distance;
    most += static_cast<Real>(kArmingDepth) + static_cast<Real>(kArmingSteps) * h * std::sqrt(velocity.dot(velocity));
  } else {
    most +=
        FindFreeDepth(parameters) + static_cast<Real>(kArmingSteps) * h * std::max(Real(0), -at.normal.dot(velocity));
  }
  contact.leap += std::max(Real(0), depth - contact.leap - most);
  contact.leap = std::clamp(contact.leap, Real(0), std::max(Real(0), depth));
}

// FindPresentFace after a substep of h, with the distance that counts for the force.
template <class Real>
FacePoint<Real> RenewContact(const ContactParameters<Real>& parameters, const Meeting<Real>& meeting,
                             const Vector3<Real>& p, Real h, BodyContact<Real>& contact) {
  const bool wasBehind = contact.behind;
  const FacePoint<Real> before = FindFacePoint(FaceSkin(meeting, wasBehind), contact.face, p);
  FacePoint<Real> at = FindPresentFace(meeting, p, contact);
  if (!contact.armed || contact.behind != wasBehind) {
    contact.leap = 0;
    return at;
  }
  NoteLeap(parameters, meeting, before, at, h, contact);
  at.distance += contact.leap;
  return at;
}

// Within a step: where the contact's vertex is to the face that it had or the one beside it.
template <class Real>
FacePoint<Real> FindReach(const Meeting<Real>& meeting, const Vector3<Real>& p, const BodyContact<Real>& contact) {
  FacePoint<Real> at = FollowContact(FaceSkin(meeting, contact.behind), contact, p);
  at.distance += contact.leap;
  return at;
}

// The stick spring of a touching contact, m.
template <class Real>
Vector3<Real> FindSlip(const Meeting<Real>& meeting, const BodyContact<Real>& contact, const Vector3<Real>& p,
                       const Vector3<Real>& normal) {
  const Vector3<Real> foot = Blend<Real>(contact.foot, meeting.skin.faces[contact.face], meeting.skin.x);
  return RemoveNormalPart<Real>(contact.slip + p - foot, normal);
}

// RenewContact at the beginning of a tick. Where the vertex stands over its face as the last substep left it, which is
// nearly always, the face is still its own.
template <class Real>
FacePoint<Real> RecallContact(const ContactParameters<Real>& parameters, const Meeting<Real>& meeting,
                              const Vector3<Real>& p, BodyContact<Real>& contact) {
  FacePoint<Real> at = FindFacePoint(FaceSkin(meeting, contact.behind), contact.face, p);
  const bool stands = (at.weights - contact.foot).cwiseAbs().maxCoeff() < static_cast<Real>(kStandingOverhang) &&
                      at.weights.minCoeff() >= Real(0);
  if (!stands || !contact.armed || LooksAlong(at, contact.outward)) {
    return RenewContact(parameters, meeting, p, Real(0), contact);
  }
  NoteLeap(parameters, meeting, at, at, Real(0), contact);
  at.distance += contact.leap;
  return at;
}

// The search of one side, vertex by vertex.
template <class Real>
class SideSearch {
 public:
  SideSearch(const ContactParameters<Real>& parameters, const Meeting<Real>& meeting, const Skin<Real>& own,
             const ContactSearch<Real>& search)
      : m_parameters(parameters),
        m_meeting(meeting),
        m_own(own),
        m_search(search),
        m_isOpen(meeting.skin.topology->isOpen),
        m_bothClosed(!m_isOpen && !own.topology->isOpen),
        m_velocity(m_search.vertices->Velocity() - m_search.skin->Velocity()) {}

  // Of the vertices those in the skin's fat box and near enough to the ball that holds it.
  std::span<const std::uint16_t> FindCandidates(std::vector<std::uint16_t>& found) const {
    const Vector3<Real> toCentre = m_search.skin->Centre() - m_meeting.shift;
    const Real apart = m_search.skin->Radius() + FindReach(m_velocity, m_search.vertices->Agitation());
    const Real farthest = apart + m_search.vertices->Radius();
    if ((m_search.vertices->Centre() - toCentre).squaredNorm() > farthest * farthest) return {};
    NearRegion<Real> region;
    for (int axis = 0; axis < 3; ++axis) {
      region.low[axis] = m_search.near.low[axis] - m_meeting.shift[axis];
      region.high[axis] = m_search.near.high[axis] - m_meeting.shift[axis];
      region.centre[axis] = toCentre[axis];
    }
    region.squaredRadius = apart * apart;
    const PointLanes<Real> points = m_search.vertices->Lanes();
    found.resize(points.count);
    return std::span(found).first(m_search.kernel.findWithin(points, region, found.data()));
  }

  // Whether the vertex may touch; fills what follows of its contact. known: since the last tick.
  bool Look(std::uint16_t vertex, bool known, BodyContact<Real>& contact) const {
    const Vector3<Real> p = m_meeting.x[vertex] + m_meeting.shift;
    FacePoint<Real> at;
    if (known) {
      if (m_bothClosed) contact.outward = FindOutward(m_own, vertex);
      at = RecallContact(m_parameters, m_meeting, p, contact);
    } else if (!FindFirstFace(p, at, contact)) {
      return false;
    }
    const Vector3<Real> velocity = FindRelativeVelocity(m_meeting, vertex, at);
    if (IsOutOfReach(at, velocity)) return false;
    Arm(m_parameters, velocity, m_search.duration / static_cast<Real>(kLikelySubsteps), m_isOpen, at, contact);
    if (!known) contact.depth = -at.distance;
    contact.face = at.face;
    contact.foot = at.weights;
    return true;
  }

 private:
  // That IsOutOfReach may grant to a vertex with this velocity, give or take `agitation`, against the skin's.
  Real FindReach(const Vector3<Real>& velocity, Real agitation) const {
    const Real fastest = std::sqrt(velocity.dot(velocity)) + agitation + m_search.skin->Agitation();
    return m_search.margin + (m_isOpen ? m_search.near.speed : fastest) * m_search.duration;
  }

  // What a sheet does next its present motion hardly tells: it is light, and passed over unseen it is passed for good.
  bool IsOutOfReach(const FacePoint<Real>& at, const Vector3<Real>& velocity) const {
    const Real approach = m_isOpen ? m_search.near.speed : std::max(Real(0), -at.normal.dot(velocity));
    return at.distance > m_search.margin + approach * m_search.duration;
  }

  // With D the distance to the nearest vertex and d that to the surface, D² ≤ d² + SquaredGap.
  bool FindFirstFace(const Vector3<Real>& p, FacePoint<Real>& at, BodyContact<Real>& contact) const {
    const Real reach = FindReach(m_meeting.v[contact.vertex] - m_search.skin->Velocity(), Real(0));
    const NearestPoint<Real> nearest = m_search.kernel.findNearest(m_search.skin->Lanes(), p.data());
    if (nearest.square > reach * reach + m_search.skin->SquaredGap()) return false;
    const Skin<Real>& skin = m_meeting.skin;
    at = FindNearestFace(skin, FindStart(skin, skin.topology->vertices[nearest.index], p), p);
    if (at.distance > reach) return false;
    // No other face can be as near to a vertex that is straight above this one.
    const bool isAbove = at.distance >= Real(0) && at.weights.minCoeff() >= Real(0);
    if (isAbove && IsOutOfReach(at, FindRelativeVelocity(m_meeting, contact.vertex, at))) return false;
    if (m_bothClosed) contact.outward = FindOutward(m_own, contact.vertex);
    at = ChooseSide(m_meeting, at, p, contact.outward, contact.behind);
    return true;
  }

  const ContactParameters<Real>& m_parameters;
  const Meeting<Real>& m_meeting;
  const Skin<Real>& m_own;
  const ContactSearch<Real>& m_search;
  bool m_isOpen;
  bool m_bothClosed;
  Vector3<Real> m_velocity;  // of one body against the other, m/s
};

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
void FindBodyContacts(const ContactParameters<Real>& parameters, const Meeting<Real>& meeting, const Skin<Real>& own,
                      const ContactSearch<Real>& search, std::vector<BodyContact<Real>>& contacts,
                      ContactSearchScratch<Real>& scratch) {
  const SideSearch<Real> side(parameters, meeting, own, search);
  scratch.contacts.clear();
  auto kept = contacts.begin();
  for (const std::uint16_t index : side.FindCandidates(scratch.found)) {
    const std::uint16_t vertex = own.topology->vertices[index];
    while (kept != contacts.end() && kept->vertex < vertex) ++kept;
    const bool known = kept != contacts.end() && kept->vertex == vertex;
    BodyContact<Real> contact = known ? *kept : BodyContact<Real>{.vertex = vertex};
    if (side.Look(vertex, known, contact)) scratch.contacts.push_back(contact);
  }
  contacts.swap(scratch.contacts);
}

template <class Real>
void ComputeBodyContacts(const ContactParameters<Real>& parameters, const Meeting<Real>& meeting,
                         std::span<const BodyContact<Real>> contacts, std::span<ContactForce<Real>> forces) {
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const BodyContact<Real>& contact = contacts[c];
    ContactForce<Real>& result = forces[c];
    result.acts = false;
    if (!contact.armed) continue;
    const Vector3<Real> p = meeting.x[contact.vertex] + meeting.shift;
    const FacePoint<Real> at = FindReach(meeting, p, contact);
    if (!Pushes(contact, at)) continue;
    const Real depth = -at.distance;
    const Face& face = meeting.skin.faces[at.face];
    const Vector3<Real> velocity = FindRelativeVelocity(meeting, contact.vertex, at);
    const Real rate = -at.normal.dot(velocity);
    const Real normalForce = ComputeNormalForce(parameters, depth, rate);
    Vector3<Real> pull = parameters.stickDamping * RemoveNormalPart<Real>(velocity, at.normal);
    if (contact.touching) pull += parameters.stickStiffness * FindSlip(meeting, contact, p, at.normal);
    const Real limit = parameters.friction * normalForce;
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
    const Real lever = std::min(depth / at.doubleArea, Real(1) / longest);
    const Real winding = contact.behind ? Real(-1) : Real(1);  // the sides go round the other way
    const Vector3<Real> turned = pull.cross(at.normal) * (winding * share * lever);
    for (std::size_t i = 0; i < 3; ++i) {
      result.onCorners[i] = turned.dot(sides[i]) * at.normal - at.weights[static_cast<Eigen::Index>(i)] * force;
    }
  }
}

template <class Real>
void UpdateBodyContacts(const ContactParameters<Real>& parameters, const Meeting<Real>& meeting, Real h,
                        std::span<BodyContact<Real>> contacts) {
  for (BodyContact<Real>& contact : contacts) {
    const Vector3<Real> p = meeting.x[contact.vertex] + meeting.shift;
    FacePoint<Real> at = RenewContact(parameters, meeting, p, h, contact);
    Arm<Real>(parameters, FindRelativeVelocity(meeting, contact.vertex, at), h, meeting.skin.topology->isOpen, at,
              contact);
    const Real depth = -at.distance;
    Vector3<Real> slip = Vector3<Real>::Zero();
    if (contact.touching) {
      slip = FindSlip(meeting, contact, p, at.normal);
      const Real limit = parameters.friction * ComputePenalty(parameters, depth);
      const Real strength = parameters.stickStiffness * std::sqrt(slip.dot(slip));
      if (strength > limit) slip *= limit / strength;
    }
    contact.touching = Pushes(contact, at);
    contact.depth = contact.touching ? depth : std::min(depth, Real(0));
    contact.face = at.face;
    contact.foot = at.weights;
    contact.slip = slip;
  }
}

template <class Real>
double ComputeBodyContactEnergy(const ContactParameters<Real>& parameters, const Meeting<Real>& meeting,
                                std::span<const BodyContact<Real>> contacts) {
  double energy = 0;
  for (const BodyContact<Real>& contact : contacts) {
    const Vector3<Real> p = meeting.x[contact.vertex] + meeting.shift;
    const FacePoint<Real> at = FindReach(meeting, p, contact);
    if (!Pushes(contact, at)) continue;
    Real stored = ComputePenaltyEnergy(parameters, -at.distance);
    if (contact.touching) {
      const Vector3<Real> slip = FindSlip(meeting, contact, p, at.normal);
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
    if (!contact.armed) continue;
    const FacePoint<Real> at =
        FindFacePoint<Real>(FaceSkin(meeting, contact.behind), contact.face, meeting.x[contact.vertex] + meeting.shift);
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
  template void FindBodyContacts<Real>(const ContactParameters<Real>&, const Meeting<Real>&, const Skin<Real>&,   \
                                       const ContactSearch<Real>&, std::vector<BodyContact<Real>>&,               \
                                       ContactSearchScratch<Real>&);                                              \
  template void ComputeBodyContacts<Real>(const ContactParameters<Real>&, const Meeting<Real>&,                   \
                                          std::span<const BodyContact<Real>>, std::span<ContactForce<Real>>);     \
  template void UpdateBodyContacts<Real>(const ContactParameters<Real>&, const Meeting<Real>&, Real,              \
                                         std::span<BodyContact<Real>>);                                           \
  template double ComputeBodyContactEnergy<Real>(const ContactParameters<Real>&, const Meeting<Real>&,            \
                                                 std::span<const BodyContact<Real>>);                             \
  template int AddContactLoads<Real>(const ContactParameters<Real>&, const Meeting<Real>&,                        \
                                     std::span<const BodyContact<Real>>, double, std::span<VertexLoad>,           \
                                     std::span<VertexLoad>);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
