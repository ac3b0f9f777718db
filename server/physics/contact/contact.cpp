// The laws are smooth functions of depth and rate so that RK4 keeps its order through a contact; damping that sets in
// with depth, an anchor instead of friction by slip speed, and the tangent of the magnetic law serve that (contact.h).
// The search reads bounds of the whole body first, then vertices in blocks, then each vertex that is left by itself.
#include "server/physics/contact/contact.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "server/physics/model/roots.h"

namespace wobble::physics {
namespace {

// δ as a share of the body's size: 7.5 mm on a ball of 1 m, inside the 5-10 mm at which the law was found to hold.
constexpr double kFadeShare = 0.0075;
// Stiffness of the stick spring over k: stiff enough that a body at rest creeps by less than its contact depth.
constexpr double kStickShare = 0.5;
// Damping of its dashpot over the critical damping of the vertex alone: a slide ends without ringing.
constexpr double kStickDampingRatio = 0.3;
// A vertex that comes in over the edge of ground may be this deep without being buried, m.
constexpr double kBuriedDepth = 0.01;

// The terms of the penalty law at one contact, before the vertex's share: N · normal − kept · pull is the force.
template <class Real>
struct PenaltyForce {
  Vector3<Real> normal = Vector3<Real>::UnitZ();
  Real depth = 0;                              // m; 0: the vertex is outside and there is no force
  Real normalForce = 0;                        // N
  Vector3<Real> pull = Vector3<Real>::Zero();  // friction before Coulomb's limit, N
  Real kept = 1;                               // share of the pull that the limit leaves, 0..1
};

template <class Real>
PenaltyForce<Real> FindPenaltyForce(const ContactParameters<Real>& parameters, const Surface<Real>& surface,
                                    const Contact<Real>& contact, const Vector3<Real>& x,
                                    const Vector3<Real>& velocity) {
  const SurfacePoint<Real> point = FindContactPoint(surface, contact, x);
  PenaltyForce<Real> penalty;
  if (!(point.distance < Real(0))) return penalty;
  penalty.normal = point.normal;
  penalty.depth = -point.distance;
  penalty.normalForce = ComputeNormalForce(parameters, penalty.depth, -point.normal.dot(velocity));
  penalty.pull = parameters.stickDamping * RemoveNormalPart<Real>(velocity, point.normal);
  const Real friction = parameters.friction * surface.friction;
  if (contact.touching) {
    penalty.pull += FindStickPull<Real>(parameters, friction, penalty.depth,
                                        RemoveNormalPart<Real>(x - contact.anchor, point.normal));
  }
  const Real limit = friction * penalty.normalForce;
  const Real strength = std::sqrt(penalty.pull.dot(penalty.pull));
  if (strength > limit) penalty.kept = limit / strength;
  return penalty;
}

// The share of the magnetic force that the fade leaves at a distance, 0..1, and how fast it falls with it, 1/m.
template <class Real>
struct Fade {
  Real share = 1;
  Real slope = 0;
};

template <class Real>
Fade<Real> FindFade(const ContactParameters<Real>& parameters, Real distance) {
  const Real half = parameters.range / Real(2);
  const Real s = std::clamp((parameters.range - distance) / half, Real(0), Real(1));
  return {s * s * (Real(3) - Real(2) * s), Real(6) * s * (Real(1) - s) / half};
}

// FindContactPoint as if the contact were not buried. side: Contact::side.
template <class Real>
SurfacePoint<Real> FindPointFromSide(const Surface<Real>& surface, const Vector3<Real>& side, const Vector3<Real>& x) {
  const SurfacePoint<Real> point = FindSurfacePoint(surface, x);
  if (surface.kind != Obstacle::Kind::kBox || !(point.normal.dot(side) < Real(0))) return point;
  const Vector3<Real> fromCentre = x - surface.centre;
  int axis = 0;
  const Real component = side.cwiseAbs().maxCoeff(&axis);
  const Vector3<Real> beyond = fromCentre.cwiseAbs() - surface.halfExtents;
  for (int other = 0; other < 3; ++other) {
    if (other != axis && beyond[other] > surface.radius) return point;  // it has gone round
  }
  Vector3<Real> normal = Vector3<Real>::Zero();
  normal[axis] = side[axis] / component;
  return {normal.dot(fromCentre) - surface.halfExtents[axis] - surface.radius, normal};
}

// True if a vertex that has not been near the surface has entered ground through the open side at the field's border.
// Ground has no walls where its heights end. A spring that nobody pressed would lift such a vertex, as hard as it is
// deep: a ball that had rolled off the edge, and under it, was shot out at fifteen kilometres a second. mean: of the
// body, m/s; where the vertices of a ball quiver, their own velocities say little of the way that they have come. most:
// deeper than this, m, nothing can have come through the surface.
template <class Real>
bool HasComeFromBeside(const Surface<Real>& surface, const SurfacePoint<Real>& point, const Vector3<Real>& x,
                       const Vector3<Real>& v, const Vector3<Real>& mean, Real duration, Real most) {
  if (surface.kind != Obstacle::Kind::kHeightField || point.distance > -static_cast<Real>(kBuriedDepth)) return false;
  const auto wasBeyond = [&](const Vector3<Real>& velocity) {
    const Vector3<Real> before = x - Real(2) * duration * velocity;
    return FindSurfacePoint(surface, before).distance >= static_cast<Real>(kBeyond);
  };
  return point.distance < -most || wasBeyond(v) || wasBeyond(mean);
}

// UpdateAnchors for one contact, whose vertex is at x and v.
template <class Real>
void UpdateAnchor(const ContactParameters<Real>& parameters, const Surface<Real>& surface, Real h,
                  const Vector3<Real>& x, const Vector3<Real>& v, Contact<Real>& contact) {
  const SurfacePoint<Real> point = FindContactPoint(surface, contact, x);
  contact.side = point.normal;
  if (parameters.law == ContactLaw::kMagnetic) {
    contact.touching = point.distance < parameters.range / Real(2);
    return;
  }
  const bool wasTouching = contact.touching;
  contact.touching = point.distance < Real(0);
  if (!contact.touching) return;
  const Real friction = parameters.friction * surface.friction;
  const Real depth = -point.distance;
  if (!wasTouching) contact.anchor = x - FindFirstSlip(h, depth, point.normal, v);
  contact.anchor = DragAnchor<Real>(parameters, friction, depth, point.normal, x, contact.anchor);
}

// Calls visit(vertex), ascending, for every vertex that may come within `reach` m of the surface in `duration` s, by
// its distance and its approach, which counts as at least `shaken` m/s. Only planes are tested so; for other surfaces
// all vertices are visited.
template <class Real, class Visit>
void VisitNear(const Surface<Real>& surface, Real reach, Real shaken, Real duration, std::span<const Vector3<Real>> x,
               std::span<const Vector3<Real>> v, const Visit& visit) {
  if (surface.kind != Obstacle::Kind::kPlane) {
    for (std::uint32_t i = 0; i < x.size(); ++i) visit(i);
    return;
  }
  const Real limit = reach + surface.offset;
  const auto findHeight = [&surface](const Real* numbers) {
    return surface.normal[0] * numbers[0] + surface.normal[1] * numbers[1] + surface.normal[2] * numbers[2];
  };
  constexpr std::size_t kBlock = 32;
  for (std::size_t begin = 0; begin < x.size(); begin += kBlock) {
    std::array<Real, kBlock> heights;
    const std::size_t count = std::min(kBlock, x.size() - begin);
    const Real* places = x[begin].data();
    const Real* speeds = v[begin].data();
    for (std::size_t i = 0; i < count; ++i) {
      heights[i] = findHeight(places + 3 * i) - duration * std::max(shaken, -findHeight(speeds + 3 * i));
    }
    for (std::size_t i = 0; i < count; ++i) {
      if (!(heights[i] > limit)) visit(static_cast<std::uint32_t>(begin + i));
    }
  }
}

// Whether any contact from `kept` on touches this box, which is number s.
template <class Real, class Iterator>
bool IsHeld(const Surface<Real>& surface, std::uint32_t s, Iterator kept, Iterator end) {
  if (surface.kind != Obstacle::Kind::kBox) return false;
  return std::any_of(kept, end, [s](const Contact<Real>& each) { return each.surface == s && each.touching; });
}

bool ComesBefore(std::uint32_t surfaceA, std::uint32_t vertexA, std::uint32_t surfaceB, std::uint32_t vertexB) {
  return surfaceA != surfaceB ? surfaceA < surfaceB : vertexA < vertexB;
}

}  // namespace

ContactParameters<double> MakeContactParameters(const Material& material, double vertexMass, double size) {
  ContactParameters<double> p;
  p.stiffness = material.contactStiffness > 0 ? material.contactStiffness : kContactStiffnessRatio * material.stiffness;
  p.fadeDepth = kFadeShare * size;
  // A linear contact with damping ratio ζ comes back with e = exp(−πζ/√(1 − ζ²)); solved for ζ.
  const double logarithm = std::log(std::max(material.restitution, 1e-3));
  constexpr double kPi = 3.14159265358979323846;
  const double ratio = -logarithm / std::sqrt(kPi * kPi + logarithm * logarithm);
  p.damping = 2 * ratio * std::sqrt(p.stiffness * vertexMass);
  p.stickStiffness = kStickShare * p.stiffness;
  p.stickDamping = 2 * kStickDampingRatio * std::sqrt(p.stickStiffness * vertexMass);
  p.friction = material.friction;
  p.rollingResistance = material.rollingResistance;
  p.restitution = material.restitution;
  return p;
}

void FillMagneticLaw(ContactParameters<double>& parameters, double strength, double vertexMass) {
  constexpr double kGravity = 9.81;
  parameters.strength = strength;
  parameters.floorDistance = FindCubeRoot(2 * strength / parameters.stiffness);
  // The distance at which 1 % of a vertex's weight is carried, but never so near that the fade would cut the tangent.
  parameters.range = std::max(10 * std::sqrt(strength / (vertexMass * kGravity)), 4 * parameters.floorDistance);
}

template <class Real>
Real ComputeMagneticForce(const ContactParameters<Real>& parameters, Real distance) {
  if (distance >= parameters.range) return 0;
  const Real floor = parameters.floorDistance;
  if (distance < floor) return parameters.strength / (floor * floor) * (Real(3) - Real(2) * distance / floor);
  return parameters.strength / (distance * distance) * FindFade(parameters, distance).share;
}

template <class Real>
Real ComputeMagneticSlope(const ContactParameters<Real>& parameters, Real distance) {
  if (distance >= parameters.range) return 0;
  const Real at = std::max(distance, parameters.floorDistance);
  const Fade<Real> fade = FindFade(parameters, at);
  return parameters.strength / (at * at) * (Real(2) / at * fade.share + fade.slope);
}

template <class Real>
ContactRates FindRates(const ContactParameters<Real>& parameters, double depth, double mass) {
  const auto at = static_cast<Real>(depth);
  if (parameters.law == ContactLaw::kMagnetic) {
    // The law is stiffest at the least distance.
    return {double{ComputeMagneticSlope(parameters, -at)} / mass, 0};
  }
  if (parameters.law == ContactLaw::kBacktracking || !(depth > 0)) return {};
  const double normalDamping = double{parameters.damping} * double{ComputeDampingShare(parameters, at)};
  return {(double{ComputePenaltySlope(parameters, at)} + double{parameters.stickStiffness}) / mass,
          (normalDamping + double{parameters.stickDamping}) / mass};
}

template <class Real>
Real ComputePenalty(const ContactParameters<Real>& parameters, Real depth) {
  const Real delta = parameters.fadeDepth;
  if (depth <= Real(0)) return 0;
  return depth < delta ? parameters.stiffness * depth * depth / (Real(2) * delta)
                       : parameters.stiffness * (depth - delta / Real(2));
}

template <class Real>
Real ComputePenaltySlope(const ContactParameters<Real>& parameters, Real depth) {
  if (depth <= Real(0)) return 0;
  return parameters.stiffness * std::min(Real(1), depth / parameters.fadeDepth);
}

template <class Real>
Real ComputePenaltyEnergy(const ContactParameters<Real>& parameters, Real depth) {
  const Real delta = parameters.fadeDepth;
  if (depth <= Real(0)) return 0;
  if (depth < delta) return parameters.stiffness * depth * depth * depth / (Real(6) * delta);
  return parameters.stiffness * (depth * (depth - delta) / Real(2) + delta * delta / Real(6));
}

template <class Real>
Real ComputeDampingShare(const ContactParameters<Real>& parameters, Real depth) {
  const Real s = std::clamp(depth / parameters.fadeDepth, Real(0), Real(1));
  return s * s * (Real(3) - Real(2) * s);
}

template <class Real>
Real ComputeNormalForce(const ContactParameters<Real>& parameters, Real depth, Real rate) {
  return std::max(
      Real(0), ComputePenalty(parameters, depth) + parameters.damping * ComputeDampingShare(parameters, depth) * rate);
}

template <class Real>
SurfacePoint<Real> FindOtherContactPoint(const Surface<Real>& surface, const Contact<Real>& contact,
                                         const Vector3<Real>& x) {
  if (contact.buried) return {static_cast<Real>(kBeyond), FindSurfacePoint(surface, x).normal};
  return FindPointFromSide(surface, contact.side, x);
}

template <class Real>
void FindContacts(const SurfaceSearch<Real>& search, std::vector<Contact<Real>>& contacts,
                  std::vector<Contact<Real>>& scratch) {
  scratch.clear();
  const Bounds<Real>& bounds = search.survey.bounds;
  const Vector3<Real> half = (bounds.high - bounds.low) / Real(2);
  const Vector3<Real> middle = bounds.low + half;
  const Real margin = search.range + static_cast<Real>(kNearMargin);
  const Real halfDiagonal = std::sqrt(half.dot(half));
  const Real reach = halfDiagonal + bounds.speed * search.duration + margin;
  const Vector3<Real> mean = search.survey.bulk.velocity.template cast<Real>();
  auto kept = contacts.begin();
  for (std::uint32_t s = 0; s < search.surfaces.size(); ++s) {
    const Surface<Real>& surface = search.surfaces[s];
    // The clearance is a lower bound of the distance: one look at the middle clears a whole body that is far off. Not
    // one that a box still pulls back: a heavy body on a soft contact comes to a halt far behind a thin wall.
    if (FindClearance(surface, middle) > reach && !IsHeld(surface, s, kept, contacts.end())) continue;
    // VisitNear may be wrong by rounding, so its reach is a little longer than that of the exact test below.
    const Real shakenMost =
        std::max(Real(0), FindApproach<Real>(surface, {0, surface.normal}, mean)) + search.survey.agitation;
    const Real longer = Real(1.001) * search.duration;
    VisitNear<Real>(surface, Real(1.001) * margin, shakenMost, longer, search.x, search.v, [&](std::uint32_t i) {
      while (kept != contacts.end() && ComesBefore(kept->surface, kept->vertex, s, i)) ++kept;
      const bool known = kept != contacts.end() && kept->surface == s && kept->vertex == i;
      Contact<Real> contact = known ? *kept : Contact<Real>{.surface = s, .vertex = i};
      const Vector3<Real>& x = search.x[i];
      const Vector3<Real>& v = search.v[i];
      const SurfacePoint<Real> point = FindPointFromSide(surface, contact.side, x);
      // A body that vibrates faster than a tick throws a vertex onto a surface at the speed of any other vertex. When
      // the vertex's own speed alone counted, it was a hand deep in the ground at the next search, and what lifted it
      // out was energy from nowhere that no check sees, since it comes between two ticks.
      const Real own = FindApproach(surface, point, v);
      const Real shaken = FindApproach(surface, point, mean) + search.survey.agitation;
      const Real way = std::max({Real(0), own, shaken}) * search.duration;
      if (point.distance > margin + way) return;
      // A contact becomes buried when it is first seen, or never; burial ends when the vertex comes out above ground.
      const Real most = Real(2) * (halfDiagonal + way);  // what was put into the ground is not as deep, too
      contact.buried = known ? contact.buried && point.distance < Real(0)
                             : HasComeFromBeside(surface, point, x, v, mean, search.duration, most);
      contact.side = point.normal;
      scratch.push_back(contact);
    });
  }
  // Copied, not swapped: swapped lists wander from body to body with the capacity of another, and each has to grow
  // again.
  if (scratch.size() > contacts.capacity()) contacts.reserve(std::max(scratch.size(), search.x.size()));
  contacts.assign(scratch.begin(), scratch.end());
}

template <class Real>
void AddContacts(const ContactParameters<Real>& parameters, std::span<const Real> shares,
                 std::span<const Surface<Real>> surfaces, std::span<const Contact<Real>> contacts,
                 std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v, std::span<Vector3<Real>> forces) {
  if (parameters.law == ContactLaw::kBacktracking) return;
  for (const Contact<Real>& contact : contacts) {
    const std::uint32_t i = contact.vertex;
    const Surface<Real>& surface = surfaces[contact.surface];
    if (parameters.law == ContactLaw::kMagnetic) {
      const SurfacePoint<Real> point = FindContactPoint(surface, contact, x[i]);
      forces[i] += (shares[i] * ComputeMagneticForce(parameters, point.distance)) * point.normal;
      continue;
    }
    const PenaltyForce<Real> penalty = FindPenaltyForce(parameters, surface, contact, x[i], v[i]);
    if (!(penalty.depth > Real(0))) continue;
    forces[i] += shares[i] * (penalty.normalForce * penalty.normal - penalty.kept * penalty.pull);
  }
}

template <class Real>
ContactStiffness<Real> FindContactStiffness(const ContactParameters<Real>& parameters, std::span<const Real> shares,
                                            std::span<const Surface<Real>> surfaces, const Contact<Real>& contact,
                                            std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v) {
  const std::uint32_t i = contact.vertex;
  const Surface<Real>& surface = surfaces[contact.surface];
  ContactStiffness<Real> found;
  if (parameters.law == ContactLaw::kBacktracking) return found;
  if (parameters.law == ContactLaw::kMagnetic) {
    const SurfacePoint<Real> point = FindSurfacePoint(surface, x[i]);
    found.normal = point.normal;
    found.stiffness = shares[i] * ComputeMagneticSlope(parameters, point.distance);
    return found;
  }
  const PenaltyForce<Real> penalty = FindPenaltyForce(parameters, surface, contact, x[i], v[i]);
  if (!(penalty.normalForce > Real(0))) return found;
  found.normal = penalty.normal;
  found.stiffness = shares[i] * ComputePenaltySlope(parameters, penalty.depth);
  found.damping = shares[i] * parameters.damping * ComputeDampingShare(parameters, penalty.depth);
  found.stickStiffness = contact.touching ? shares[i] * penalty.kept * parameters.stickStiffness : Real(0);
  found.stickDamping = shares[i] * penalty.kept * parameters.stickDamping;
  return found;
}

template <class Real>
void UpdateAnchors(const ContactParameters<Real>& parameters, std::span<const Surface<Real>> surfaces,
                   std::span<Contact<Real>> contacts, Real h, std::span<const Vector3<Real>> x,
                   std::span<const Vector3<Real>> v) {
  if (parameters.law == ContactLaw::kBacktracking) return;
  for (Contact<Real>& contact : contacts) {
    UpdateAnchor<Real>(parameters, surfaces[contact.surface], h, x[contact.vertex], v[contact.vertex], contact);
  }
}

template <class Real>
double ComputeContactEnergy(const Coefficients<Real>& body, std::span<const Surface<Real>> surfaces,
                            std::span<const Contact<Real>> contacts, std::span<const Vector3<Real>> x) {
  double energy = 0;
  if (body.contact.law != ContactLaw::kPenalty) return energy;
  for (const Contact<Real>& contact : contacts) {
    const SurfacePoint<Real> point = FindContactPoint(surfaces[contact.surface], contact, x[contact.vertex]);
    Real stored = ComputePenaltyEnergy(body.contact, -point.distance);
    if (contact.touching) {
      const Vector3<Real> slip = RemoveNormalPart<Real>(x[contact.vertex] - contact.anchor, point.normal);
      stored += body.contact.stickStiffness * slip.dot(slip) / Real(2);
    }
    energy += double{body.contactShares[contact.vertex] * stored};
  }
  return energy;
}

#define WOBBLE_INSTANTIATE(Real)                                                                                   \
  template Real ComputePenalty<Real>(const ContactParameters<Real>&, Real);                                        \
  template double ComputeContactEnergy<Real>(const Coefficients<Real>&, std::span<const Surface<Real>>,            \
                                             std::span<const Contact<Real>>, std::span<const Vector3<Real>>);      \
  template Real ComputePenaltyEnergy<Real>(const ContactParameters<Real>&, Real);                                  \
  template Real ComputePenaltySlope<Real>(const ContactParameters<Real>&, Real);                                   \
  template Real ComputeNormalForce<Real>(const ContactParameters<Real>&, Real, Real);                              \
  template Real ComputeDampingShare<Real>(const ContactParameters<Real>&, Real);                                   \
  template Real ComputeMagneticForce<Real>(const ContactParameters<Real>&, Real);                                  \
  template Real ComputeMagneticSlope<Real>(const ContactParameters<Real>&, Real);                                  \
  template ContactRates FindRates<Real>(const ContactParameters<Real>&, double, double);                           \
  template SurfacePoint<Real> FindOtherContactPoint<Real>(const Surface<Real>&, const Contact<Real>&,              \
                                                          const Vector3<Real>&);                                   \
  template void FindContacts<Real>(const SurfaceSearch<Real>&, std::vector<Contact<Real>>&,                        \
                                   std::vector<Contact<Real>>&);                                                   \
  template void AddContacts<Real>(const ContactParameters<Real>&, std::span<const Real>,                           \
                                  std::span<const Surface<Real>>, std::span<const Contact<Real>>,                  \
                                  std::span<const Vector3<Real>>, std::span<const Vector3<Real>>,                  \
                                  std::span<Vector3<Real>>);                                                       \
  template ContactStiffness<Real> FindContactStiffness<Real>(                                                      \
      const ContactParameters<Real>&, std::span<const Real>, std::span<const Surface<Real>>, const Contact<Real>&, \
      std::span<const Vector3<Real>>, std::span<const Vector3<Real>>);                                             \
  template void UpdateAnchors<Real>(const ContactParameters<Real>&, std::span<const Surface<Real>>,                \
                                    std::span<Contact<Real>>, Real, std::span<const Vector3<Real>>,                \
                                    std::span<const Vector3<Real>>);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
