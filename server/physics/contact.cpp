#include "server/physics/contact.h"

#include <algorithm>
#include <cmath>

namespace wobble::physics {
namespace {

// δ as a share of the body's size: 7.5 mm on a ball of 1 m, inside the 5-10 mm at which the law was found to hold.
constexpr double kFadeShare = 0.0075;
// The stick spring against k: stiff enough that a body at rest creeps by less than its contact depth.
constexpr double kStickShare = 0.5;
// Its dashpot, as a share of critical for the vertex alone: a slide ends without ringing.
constexpr double kStickDampingRatio = 0.3;
// Candidates beyond the way a vertex goes in the tick, m: what gravity and springs may add.
constexpr double kMargin = 0.02;

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
  return p;
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
SurfacePoint<Real> FindContactPoint(const Surface<Real>& surface, const Contact<Real>& contact,
                                    const Vector3<Real>& x) {
  const SurfacePoint<Real> point = FindSurfacePoint(surface, x);
  if (surface.kind != Obstacle::Kind::kBox || !(point.normal.dot(contact.side) < Real(0))) return point;
  const Vector3<Real> fromCentre = x - surface.centre;
  int axis = 0;
  const Real component = contact.side.cwiseAbs().maxCoeff(&axis);
  const Vector3<Real> beyond = fromCentre.cwiseAbs() - surface.halfExtents;
  for (int other = 0; other < 3; ++other) {
    if (other != axis && beyond[other] > static_cast<Real>(kEdgeRadius)) return point;  // it has gone round
  }
  Vector3<Real> normal = Vector3<Real>::Zero();
  normal[axis] = contact.side[axis] / component;
  return {normal.dot(fromCentre) - surface.halfExtents[axis] - static_cast<Real>(kEdgeRadius), normal};
}

template <class Real>
void FindContacts(std::span<const Surface<Real>> surfaces, const Bounds<Real>& bounds, std::span<const Vector3<Real>> x,
                  std::span<const Vector3<Real>> v, Real duration, std::vector<Contact<Real>>& contacts,
                  std::vector<Contact<Real>>& scratch) {
  scratch.clear();
  const Vector3<Real> half = (bounds.high - bounds.low) / Real(2);
  const Vector3<Real> middle = bounds.low + half;
  const Real reach = std::sqrt(half.dot(half)) + bounds.speed * duration + static_cast<Real>(kMargin);
  auto kept = contacts.begin();
  for (std::uint32_t s = 0; s < surfaces.size(); ++s) {
    // A distance changes by at most the way gone, so one look at the middle clears a whole body that is far off.
    if (FindSurfacePoint(surfaces[s], middle).distance > reach) continue;
    for (std::uint32_t i = 0; i < x.size(); ++i) {
      while (kept != contacts.end() && ComesBefore(kept->surface, kept->vertex, s, i)) ++kept;
      const bool known = kept != contacts.end() && kept->surface == s && kept->vertex == i;
      Contact<Real> contact = known ? *kept : Contact<Real>{s, i};
      const SurfacePoint<Real> point = FindContactPoint(surfaces[s], contact, x[i]);
      const Real approach = std::max(Real(0), -point.normal.dot(v[i])) * duration;
      if (point.distance > static_cast<Real>(kMargin) + approach) continue;
      contact.side = point.normal;
      scratch.push_back(contact);
    }
  }
  contacts.swap(scratch);
}

template <class Real>
void AddContacts(const ContactParameters<Real>& parameters, std::span<const Real> shares,
                 std::span<const Surface<Real>> surfaces, std::span<const Contact<Real>> contacts,
                 std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v, std::span<Vector3<Real>> forces) {
  for (const Contact<Real>& contact : contacts) {
    const Surface<Real>& surface = surfaces[contact.surface];
    const SurfacePoint<Real> point = FindContactPoint(surface, contact, x[contact.vertex]);
    const Real depth = -point.distance;
    if (!(depth > Real(0))) continue;
    const Vector3<Real>& velocity = v[contact.vertex];
    const Real rate = -point.normal.dot(velocity);
    const Real normalForce = ComputeNormalForce(parameters, depth, rate);
    Vector3<Real> pull = parameters.stickDamping * RemoveNormalPart<Real>(velocity, point.normal);
    if (contact.touching) {
      const Vector3<Real> slip = x[contact.vertex] - contact.anchor;
      pull += parameters.stickStiffness * RemoveNormalPart<Real>(slip, point.normal);
    }
    const Real limit = parameters.friction * surface.friction * normalForce;
    const Real strength = std::sqrt(pull.dot(pull));
    if (strength > limit) pull *= limit / strength;
    forces[contact.vertex] += shares[contact.vertex] * (normalForce * point.normal - pull);
  }
}

template <class Real>
void UpdateAnchors(const ContactParameters<Real>& parameters, std::span<const Surface<Real>> surfaces,
                   std::span<Contact<Real>> contacts, std::span<const Vector3<Real>> x) {
  for (Contact<Real>& contact : contacts) {
    const Surface<Real>& surface = surfaces[contact.surface];
    const SurfacePoint<Real> point = FindContactPoint(surface, contact, x[contact.vertex]);
    contact.side = point.normal;
    const Real depth = -point.distance;
    const bool wasTouching = contact.touching;
    contact.touching = depth > Real(0);
    if (!contact.touching) continue;
    if (!wasTouching) {
      contact.anchor = x[contact.vertex];
      continue;
    }
    const Vector3<Real> slip = RemoveNormalPart<Real>(x[contact.vertex] - contact.anchor, point.normal);
    const Real limit = parameters.friction * surface.friction * ComputePenalty(parameters, depth);
    const Real strength = parameters.stickStiffness * std::sqrt(slip.dot(slip));
    if (strength > limit) contact.anchor = x[contact.vertex] - slip * (limit / strength);
  }
}

template <class Real>
double ComputeContactEnergy(const Coefficients<Real>& body, std::span<const Surface<Real>> surfaces,
                            std::span<const Contact<Real>> contacts, std::span<const Vector3<Real>> x) {
  double energy = 0;
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

#define WOBBLE_INSTANTIATE(Real)                                                                              \
  template Real ComputePenalty<Real>(const ContactParameters<Real>&, Real);                                   \
  template double ComputeContactEnergy<Real>(const Coefficients<Real>&, std::span<const Surface<Real>>,       \
                                             std::span<const Contact<Real>>, std::span<const Vector3<Real>>); \
  template Real ComputePenaltyEnergy<Real>(const ContactParameters<Real>&, Real);                             \
  template Real ComputePenaltySlope<Real>(const ContactParameters<Real>&, Real);                              \
  template Real ComputeNormalForce<Real>(const ContactParameters<Real>&, Real, Real);                         \
  template Real ComputeDampingShare<Real>(const ContactParameters<Real>&, Real);                              \
  template SurfacePoint<Real> FindContactPoint<Real>(const Surface<Real>&, const Contact<Real>&,              \
                                                     const Vector3<Real>&);                                   \
  template void FindContacts<Real>(std::span<const Surface<Real>>, const Bounds<Real>&,                       \
                                   std::span<const Vector3<Real>>, std::span<const Vector3<Real>>, Real,      \
                                   std::vector<Contact<Real>>&, std::vector<Contact<Real>>&);                 \
  template void AddContacts<Real>(const ContactParameters<Real>&, std::span<const Real>,                      \
                                  std::span<const Surface<Real>>, std::span<const Contact<Real>>,             \
                                  std::span<const Vector3<Real>>, std::span<const Vector3<Real>>,             \
                                  std::span<Vector3<Real>>);                                                  \
  template void UpdateAnchors<Real>(const ContactParameters<Real>&, std::span<const Surface<Real>>,           \
                                    std::span<Contact<Real>>, std::span<const Vector3<Real>>);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
