// The plain law of edge contacts. There is no other: such contacts are few, since only small bodies have rods, and
// sharp edges are listed only where they cross.
#include "server/physics/edges/edge_contact.h"

#include <algorithm>
#include <cmath>

#include "server/physics/kernels/contact/contact_limits.h"

namespace wobble::physics {
namespace {

// Below this sine of the angle between two edges their common normal is lost in rounding; they count as parallel.
constexpr double kParallelSine = 1e-3;
// Below this distance, m, the direction between the nearest points is lost in rounding.
constexpr double kLeastGap = 1e-7;
// Cosine from which on the common normal of two edges still tells on which side of one another they were.
constexpr double kLeastTurn = 0.5;
// Sine of the angle between two sharp edges, 17°, below which they do not act: the common normal of nearly parallel
// ones turns with every tremor, and vertices of the one are near faces of the other.
constexpr double kCrossingSine = 0.3;
// Sine of the angle by which an edge may look into a face and still look out: of two sheets laid flat on one another
// the borders do, or do not, by rounding.
constexpr double kOutSlack = 0.02;
// The same for edges that a tick may turn out, 30°.
constexpr double kTurnSlack = 0.5;
// Distance beyond the other's axis from which on two sharp edges do not act, as a share of the shorter one: deeper in,
// vertices are behind faces and know the way out. Of 1,000 random worlds fewer triangles intersect with it (by 4 %).
constexpr double kDeepestShare = 0.25;
// Most substeps that a fast contact asks for, so that it does not pass the other's axis within one.
constexpr int kMostFastSubsteps = 16;

double Clamp01(double value) { return std::clamp(value, 0.0, 1.0); }

// The parameters s and t of the nearest points of two segments a + s u and c + t w (Ericson 2005, 5.1.9). w0 = a − c.
// In double precision whatever the body's: of nearly parallel edges, s loses ε/sin² to rounding, in single precision
// all of it while kParallelSine is far.
std::array<double, 2> FindNearest(const Vector3d& u, const Vector3d& w, const Vector3d& w0) {
  const double uu = u.dot(u);
  const double ww = w.dot(w);
  const double wr = w.dot(w0);
  if (!(uu > 0)) return {0, ww > 0 ? Clamp01(wr / ww) : 0};
  const double ur = u.dot(w0);
  if (!(ww > 0)) return {Clamp01(-ur / uu), 0};
  const double uw = u.dot(w);
  const double area = uu * ww - uw * uw;
  // Parallel edges overlap along a stretch, in whose middle the force belongs: at its end it would turn them.
  double s = 0;
  if (area > kParallelSine * kParallelSine * uu * ww) {
    s = Clamp01((uw * wr - ur * ww) / area);
  } else {
    s = (Clamp01(-ur / uu) + Clamp01((uw - ur) / uu)) / 2;
  }
  double t = (uw * s + wr) / ww;
  if (t < 0 || t > 1) {
    t = Clamp01(t);
    s = Clamp01((uw * t - ur) / uu);
  }
  return {s, t};
}

template <class Real>
typename EdgeView<Real>::Side DescribeSide(const Vector3d& along, double at) {
  const double length = along.norm();
  if (!(length > 0)) return {};
  return {(along / length).cast<Real>(), static_cast<Real>(length), at > 0 && at < 1};
}

// The share of both edges in a contact: the least of their ends', so that no vertex gets more than its own.
template <class Real>
Real FindShare(const EdgeMeeting<Real>& meeting, const EdgeEnds& first, const EdgeEnds& second) {
  return std::min({meeting.first.shares[first[0]], meeting.first.shares[first[1]], meeting.second.shares[second[0]],
                   meeting.second.shares[second[1]]});
}

template <class Real>
Vector3<Real> PointOn(const VectorView<Real>& values, const EdgeEnds& ends, Real at) {
  return (Real(1) - at) * values[ends[0]] + at * values[ends[1]];
}

// The stick spring of a touching contact, m.
template <class Real>
Vector3<Real> FindEdgeSlip(const EdgeMeeting<Real>& meeting, const EdgeContact<Real>& contact,
                           const Vector3<Real>& normal) {
  const Vector3<Real> p = PointOn(meeting.first.x, meeting.first.edges[contact.first], contact.s) + meeting.shift;
  const Vector3<Real> q = PointOn(meeting.second.x, meeting.second.edges[contact.second], contact.t);
  return RemoveNormalPart<Real>(contact.slip + p - q, normal);
}

// The part of a pull along one edge that its ends can bear the torque of, N: the lever D must not be longer than the
// edge itself, or the balancing forces would exceed the friction.
template <class Real>
Real FindPullAlong(const typename EdgeView<Real>::Side& side, Real distance, const Vector3<Real>& pull) {
  if (!side.inside) return 0;
  return pull.dot(side.direction) * (side.length / std::max(std::abs(distance), side.length));
}

// Within a tick a contact that is turned may turn out; until the end of that substep it has no force.
template <class Real>
bool MayPush(const EdgeContact<Real>& contact, const EdgeView<Real>& view) {
  return view.looksOut && contact.phase != EdgePhase::kTurned;
}

// Depth that is pushed back, m; not above 0: the contact does not act.
template <class Real>
Real FindDepth(const EdgeMeeting<Real>& meeting, const EdgeContact<Real>& contact, const EdgeView<Real>& view) {
  if (!MayPush(contact, view)) return 0;
  return meeting.radius - view.distance - contact.leap;
}

// Whether the remembered normal n separates two rods by more than their radius: then n·(p − q) > r for any points p and
// q of them, so that D = |p − q| > r, in the sense of before. Most listed rods only may meet, and this is a tenth of
// what their view costs. The sense of sharp edges comes from their arcs.
template <class Real>
bool IsPlainlyApart(const EdgeMeeting<Real>& meeting, const EdgeContact<Real>& contact) {
  constexpr Real kSlack = Real(1.001);  // for rounding
  if (meeting.AreSharp()) return false;
  const EdgeEnds& ab = meeting.first.edges[contact.first];
  const EdgeEnds& cd = meeting.second.edges[contact.second];
  const auto along = [&](const Vector3<Real>& way) { return contact.normal.dot(way); };
  const Real shift = along(meeting.shift);
  const Real first = std::min(along(meeting.first.x[ab[0]]), along(meeting.first.x[ab[1]]));
  const Real second = std::max(along(meeting.second.x[cd[0]]), along(meeting.second.x[cd[1]]));
  return first + shift - second > kSlack * meeting.radius;
}

template <class Real>
EdgeForce<Real> ComputeForce(const ContactParameters<Real>& parameters, const EdgeMeeting<Real>& meeting,
                             const EdgeContact<Real>& contact) {
  EdgeForce<Real> result;
  if (IsPlainlyApart(meeting, contact)) return result;
  const EdgeView<Real> view = FindEdgeView(meeting, contact.first, contact.second, contact.normal);
  const Real depth = FindDepth(meeting, contact, view);
  if (!(depth > Real(0))) return result;
  const Real normalForce = ComputeNormalForce(parameters, depth, -view.normal.dot(view.velocity));
  Vector3<Real> pull = parameters.stickDamping * RemoveNormalPart<Real>(view.velocity, view.normal);
  if (contact.phase == EdgePhase::kTouching) {
    pull += FindStickPull<Real>(parameters, parameters.friction, depth, FindEdgeSlip(meeting, contact, view.normal));
  }
  const Real limit = parameters.friction * normalForce;
  const Real strength = std::sqrt(pull.dot(pull));
  if (strength > limit) pull *= limit / strength;

  const EdgeEnds& first = meeting.first.edges[contact.first];
  const EdgeEnds& second = meeting.second.edges[contact.second];
  const Real share = FindShare(meeting, first, second);
  const Real alongFirst = FindPullAlong<Real>(view.first, view.distance, pull);
  const Vector3<Real> rest = pull - alongFirst * view.first.direction;
  const Real alongSecond = FindPullAlong<Real>(view.second, view.distance, rest);
  const Vector3<Real> kept = alongFirst * view.first.direction + alongSecond * view.second.direction;
  const Vector3<Real> force = share * (normalForce * view.normal - kept);
  // The torque D n × (−pull) of the part along an edge, balanced by ∓ D pull/length n on the edge's ends.
  const auto balance = [&](const typename EdgeView<Real>::Side& side, Real along) -> Vector3<Real> {
    if (!side.inside) return Vector3<Real>::Zero();
    return share * view.distance * along / side.length * view.normal;
  };
  const Vector3<Real> turnFirst = balance(view.first, alongFirst);
  const Vector3<Real> turnSecond = balance(view.second, alongSecond);
  result.acts = true;
  result.vertices = {first[0], first[1], second[0], second[1]};
  result.forces = {(Real(1) - view.s) * force + turnFirst, view.s * force - turnFirst,
                   -(Real(1) - view.t) * force + turnSecond, -view.t * force - turnSecond};
  return result;
}

// FindEdgeView of two balls.
template <class Real>
EdgeView<Real> FindBallView(const EdgeMeeting<Real>& meeting, std::uint16_t first, std::uint16_t second,
                            const Vector3<Real>& normal) {
  EdgeView<Real> view;
  const Vector3<Real> gap = meeting.first.x[first] + meeting.shift - meeting.second.x[second];
  view.distance = gap.norm();
  view.normal = normal;
  if (view.distance > static_cast<Real>(kLeastGap)) view.normal = gap / view.distance;
  if (!(view.normal.squaredNorm() > Real(0))) view.normal = Vector3<Real>::UnitZ();
  view.velocity = meeting.first.v[first] - meeting.second.v[second];
  return view;
}

// Whether a sharp edge looks out in direction `out`, unit length, or into one of its faces by an angle of sine `slack`
// at most.
template <class Real>
bool LooksOut(const typename EdgeMeeting<Real>::Body& body, std::uint16_t edge, const Vector3d& out, double slack) {
  const EdgeEnds& ends = body.edges[edge];
  const Vector3d a = body.x[ends[0]].template cast<double>();
  const Vector3d along = (body.x[ends[1]].template cast<double>() - a).normalized();
  for (const std::uint16_t wing : body.wings[edge]) {
    Vector3d into = body.x[wing].template cast<double>() - a;
    into -= into.dot(along) * along;
    if (out.dot(into) > slack * into.norm()) return false;
  }
  return true;
}

// 1 or −1: the sense of the common normal n, from the second edge to the first, in which both look out, 1 if both
// senses would do; 0: neither does.
template <class Real>
int FindOutwardSense(const EdgeMeeting<Real>& meeting, std::uint16_t first, std::uint16_t second, const Vector3d& n,
                     double slack) {
  for (const int sense : {1, -1}) {
    const Vector3d toFirst = sense * n;
    if (LooksOut<Real>(meeting.first, first, -toFirst, slack) &&
        LooksOut<Real>(meeting.second, second, toFirst, slack)) {
      return sense;
    }
  }
  return 0;
}

template <class Real>
Vector3d FindAlong(const typename EdgeMeeting<Real>::Body& body, std::uint16_t edge) {
  return (body.x[body.edges[edge][1]] - body.x[body.edges[edge][0]]).template cast<double>();
}

}  // namespace

template <class Real>
Real FindTopSpeed(const EdgeMeeting<Real>& meeting, std::uint16_t first, std::uint16_t second) {
  Real square = 0;
  for (const std::uint16_t a : meeting.first.edges[first]) {
    for (const std::uint16_t b : meeting.second.edges[second]) {
      square = std::max(square, (meeting.first.v[a] - meeting.second.v[b]).squaredNorm());
    }
  }
  return std::sqrt(square);
}

double FindSegmentDistance(const std::array<Vector3d, 2>& first, const std::array<Vector3d, 2>& second) {
  const Vector3d u = first[1] - first[0];
  const Vector3d w = second[1] - second[0];
  const Vector3d between = first[0] - second[0];
  const auto [s, t] = FindNearest(u, w, between);
  return (between + s * u - t * w).norm();
}

template <class Real>
EdgeView<Real> FindEdgeView(const EdgeMeeting<Real>& meeting, std::uint16_t first, std::uint16_t second,
                            const Vector3<Real>& normal) {
  const EdgeEnds& ab = meeting.first.edges[first];
  const EdgeEnds& cd = meeting.second.edges[second];
  if (ab[0] == ab[1] && cd[0] == cd[1]) return FindBallView(meeting, ab[0], cd[0], normal);
  const Vector3d a = (meeting.first.x[ab[0]] + meeting.shift).template cast<double>();
  const Vector3d c = meeting.second.x[cd[0]].template cast<double>();
  const Vector3d u = FindAlong<Real>(meeting.first, first);
  const Vector3d w = FindAlong<Real>(meeting.second, second);
  const auto [s, t] = FindNearest(u, w, a - c);
  EdgeView<Real> view;
  view.s = static_cast<Real>(s);
  view.t = static_cast<Real>(t);
  view.velocity = PointOn(meeting.first.v, ab, view.s) - PointOn(meeting.second.v, cd, view.t);
  view.first = DescribeSide<Real>(u, s);
  view.second = DescribeSide<Real>(w, t);

  const Vector3d gap = a + s * u - (c + t * w);
  const double length = gap.norm();
  const Vector3d before = normal.template cast<double>();
  Vector3d n = length > kLeastGap ? Vector3d(gap / length) : before;
  const Vector3d across = u.cross(w);
  const double area = across.norm();
  const bool isAcross = view.first.inside && view.second.inside && area > kParallelSine * u.norm() * w.norm();
  if (isAcross) {
    n = across / area;
    const double turn = n.dot(before);
    if ((std::abs(turn) > kLeastTurn ? turn : n.dot(gap)) < 0) n = -n;
  }
  if (!(n.squaredNorm() > 0)) n = Vector3d::UnitZ();
  view.normal = n.template cast<Real>();
  view.distance = static_cast<Real>(n.dot(gap));
  if (meeting.AreSharp()) {
    const bool crosses = isAcross && area > kCrossingSine * u.norm() * w.norm();
    const int sense = crosses ? FindOutwardSense(meeting, first, second, n, kOutSlack) : 0;
    const double deepest = -kDeepestShare * std::min(u.norm(), w.norm());
    if (sense < 0) {
      view.normal = -view.normal;
      view.distance = -view.distance;
    }
    view.looksOut = sense != 0 && double{view.distance} > deepest && !(sense * n.dot(before) < 0);
  }
  return view;
}

template <class Real>
bool MayLookOut(const EdgeMeeting<Real>& meeting, std::uint16_t first, std::uint16_t second) {
  const Vector3d u = FindAlong<Real>(meeting.first, first);
  const Vector3d w = FindAlong<Real>(meeting.second, second);
  const Vector3d across = u.cross(w);
  const double area = across.norm();
  return area > kCrossingSine / 2 * u.norm() * w.norm() &&
         FindOutwardSense<Real>(meeting, first, second, across / area, kTurnSlack) != 0;
}

template <class Real>
void ComputeEdgeContacts(const ContactParameters<Real>& parameters, const EdgeMeeting<Real>& meeting,
                         std::span<const EdgeContact<Real>> contacts, std::span<EdgeForce<Real>> forces) {
  for (std::size_t i = 0; i < contacts.size(); ++i) forces[i] = ComputeForce(parameters, meeting, contacts[i]);
}

template <class Real>
void UpdateEdgeContacts(const ContactParameters<Real>& parameters, const EdgeMeeting<Real>& meeting, Real h,
                        std::span<EdgeContact<Real>> contacts) {
  for (EdgeContact<Real>& contact : contacts) {
    const EdgeView<Real> view = FindEdgeView(meeting, contact.first, contact.second, contact.normal);
    const Real speed = std::sqrt(view.velocity.dot(view.velocity));
    const Real moved = contact.phase == EdgePhase::kTurned ? Real(0) : static_cast<Real>(kArmingSteps) * h * speed;
    const Real most = contact.depth + FindFreeDepth(parameters) + moved;
    const Real whole = meeting.radius - view.distance;
    if (!view.looksOut) {
      contact = {.first = contact.first, .second = contact.second, .phase = EdgePhase::kTurned, .normal = view.normal};
      continue;
    }
    contact.leap += std::max(Real(0), whole - contact.leap - most);
    contact.leap = std::clamp(contact.leap, Real(0), std::max(Real(0), whole));
    contact.depth = whole - contact.leap;
    Vector3<Real> slip = contact.phase == EdgePhase::kTouching
                             ? FindEdgeSlip(meeting, contact, view.normal)
                             : FindFirstSlip<Real>(h, std::max(Real(0), contact.depth), view.normal, view.velocity);
    const Real limit = parameters.friction * ComputePenalty(parameters, contact.depth);
    const Real strength = parameters.stickStiffness * std::sqrt(slip.dot(slip));
    if (strength > limit) slip *= limit / strength;
    contact.slip = slip;
    contact.phase = contact.depth > Real(0) ? EdgePhase::kTouching : EdgePhase::kFree;
    contact.normal = view.normal;
    contact.s = view.s;
    contact.t = view.t;
  }
}

template <class Real>
double ComputeEdgeContactEnergy(const ContactParameters<Real>& parameters, const EdgeMeeting<Real>& meeting,
                                std::span<const EdgeContact<Real>> contacts) {
  double energy = 0;
  for (const EdgeContact<Real>& contact : contacts) {
    const EdgeView<Real> view = FindEdgeView(meeting, contact.first, contact.second, contact.normal);
    const Real depth = FindDepth(meeting, contact, view);
    if (!(depth > Real(0))) continue;
    Real stored = ComputePenaltyEnergy(parameters, depth);
    if (contact.phase == EdgePhase::kTouching) {
      const Vector3<Real> slip = FindEdgeSlip(meeting, contact, view.normal);
      stored += parameters.stickStiffness * slip.dot(slip) / Real(2);
    }
    energy +=
        double{FindShare(meeting, meeting.first.edges[contact.first], meeting.second.edges[contact.second]) * stored};
  }
  return energy;
}

template <class Real>
int AddEdgeContactLoads(const ContactParameters<Real>& parameters, const EdgeMeeting<Real>& meeting,
                        std::span<const EdgeContact<Real>> contacts, double duration, std::span<VertexLoad> loads,
                        std::span<VertexLoad> secondLoads) {
  int substeps = 1;
  for (const EdgeContact<Real>& contact : contacts) {
    const EdgeView<Real> view = FindEdgeView(meeting, contact.first, contact.second, contact.normal);
    if (!MayPush(contact, view)) continue;
    const double approach = double{FindTopSpeed(meeting, contact.first, contact.second)};
    const double depth = PredictDepth(double{FindDepth(meeting, contact, view)}, approach, duration);
    if (!(depth > 0)) continue;
    const auto reached = static_cast<Real>(depth);
    const EdgeEnds& first = meeting.first.edges[contact.first];
    const EdgeEnds& second = meeting.second.edges[contact.second];
    const double share = double{FindShare(meeting, first, second)};
    const double stiffness =
        share * double{std::max(ComputePenaltySlope(parameters, reached), parameters.stickStiffness)};
    const double damping = share * double{std::max(parameters.damping * ComputeDampingShare(parameters, reached),
                                                   parameters.stickDamping)};
    const auto add = [&](VertexLoad& load, double weight) {
      load.stiffness += 2 * weight * stiffness;
      load.damping += 2 * weight * damping;
    };
    add(loads[first[0]], double{Real(1) - view.s});
    add(loads[first[1]], double{view.s});
    add(secondLoads[second[0]], double{Real(1) - view.t});
    add(secondLoads[second[1]], double{view.t});
    // A sharp edge that has come past the other's axis still looks out in its old sense.
    if (meeting.AreSharp()) continue;
    // Two substeps for each radius of its way.
    const double asked = 2 * approach * duration / std::max(double{meeting.radius}, 1e-3);
    substeps = std::max(substeps, static_cast<int>(std::ceil(std::clamp(asked, 1.0, double{kMostFastSubsteps}))));
  }
  return substeps;
}

#define WOBBLE_INSTANTIATE(Real)                                                                            \
  template bool MayLookOut<Real>(const EdgeMeeting<Real>&, std::uint16_t, std::uint16_t);                   \
  template Real FindTopSpeed<Real>(const EdgeMeeting<Real>&, std::uint16_t, std::uint16_t);                 \
  template EdgeView<Real> FindEdgeView<Real>(const EdgeMeeting<Real>&, std::uint16_t, std::uint16_t,        \
                                             const Vector3<Real>&);                                         \
  template void ComputeEdgeContacts<Real>(const ContactParameters<Real>&, const EdgeMeeting<Real>&,         \
                                          std::span<const EdgeContact<Real>>, std::span<EdgeForce<Real>>);  \
  template void UpdateEdgeContacts<Real>(const ContactParameters<Real>&, const EdgeMeeting<Real>&, Real,    \
                                         std::span<EdgeContact<Real>>);                                     \
  template double ComputeEdgeContactEnergy<Real>(const ContactParameters<Real>&, const EdgeMeeting<Real>&,  \
                                                 std::span<const EdgeContact<Real>>);                       \
  template int AddEdgeContactLoads<Real>(const ContactParameters<Real>&, const EdgeMeeting<Real>&,          \
                                         std::span<const EdgeContact<Real>>, double, std::span<VertexLoad>, \
                                         std::span<VertexLoad>);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
