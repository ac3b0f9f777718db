// Each vertex is put back by itself, from the state at both ends of the substep; forces are not computed again. Then
// all listed surfaces are swept a few times, since a vertex that is lifted out of one may be put into another.
#include "server/physics/contact/backtracking.h"

#include <algorithm>
#include <cmath>

namespace wobble::physics {
namespace {

constexpr int kBisections = 50;
constexpr double kRestingSteps = 2;
// A vertex that is slower than this does not bounce, m/s: it would rise by half a tenth of a millimetre.
constexpr double kRestingSpeed = 0.03;
// A vertex lies on a surface if it is at most this far from it, m.
constexpr double kLyingDistance = 1e-5;
// A slip that is slower than this counts as zero, m/s: on a plane that no axis is parallel to, rounding leaves a slip
// of some 10⁻⁸ m/s, and friction in full against that is noise which lets a cube creep.
constexpr double kStuckSpeed = 1e-5;
// Sweeps over all surfaces, since a vertex that leaves one surface may be put into another.
constexpr int kSweeps = 4;

template <class Real>
struct Flight {
  Vector3<Real> x;
  Vector3<Real> v;
};

// One vertex through a substep. At(s): position and velocity after the share s, 0..1, of the substep, by the Hermite
// cubic.
template <class Real>
struct Substep {
  Real h;
  Flight<Real> begin;
  Flight<Real> end;

  [[nodiscard]] Flight<Real> At(Real s) const {
    const Vector3<Real> way = end.x - begin.x;
    const Vector3<Real> first = h * begin.v;
    const Vector3<Real> bend = Real(3) * way - Real(2) * first - h * end.v;
    const Vector3<Real> twist = first + h * end.v - Real(2) * way;
    return {begin.x + s * (first + s * (bend + s * twist)), (first + s * (Real(2) * bend + s * (Real(3) * twist))) / h};
  }
};

// The share of the substep after which the vertex meets the surface; 0 if it began at or below it.
template <class Real>
Real FindCrossing(const Surface<Real>& surface, const Substep<Real>& substep) {
  if (!(FindSurfacePoint(surface, substep.begin.x).distance > Real(0))) return 0;
  Real above = 0;
  Real below = 1;
  for (int i = 0; i < kBisections; ++i) {
    const Real middle = (above + below) / Real(2);
    (FindSurfacePoint(surface, substep.At(middle).x).distance > Real(0) ? above : below) = middle;
  }
  return above;
}

// The part of the slip that friction takes, m/s, while the normal velocity changes by `kick` m/s.
template <class Real>
Vector3<Real> FindSlowing(const Vector3<Real>& velocity, const Vector3<Real>& normal, Real friction, Real kick) {
  const Vector3<Real> slip = RemoveNormalPart<Real>(velocity, normal);
  const Real speed = std::sqrt(slip.dot(slip));
  const Real limit = friction * kick;
  return speed > limit ? Vector3<Real>(slip * (limit / speed)) : slip;
}

// Moves a vertex below the surface onto it and removes its approach.
template <class Real>
void Lift(const Surface<Real>& surface, Vector3<Real>& x, Vector3<Real>& v) {
  const SurfacePoint<Real> point = FindSurfacePoint(surface, x);
  if (!(point.distance < Real(0))) return;
  x -= point.distance * point.normal;
  v -= std::min(Real(0), point.normal.dot(v)) * point.normal;
}

// The vertex bounces at the crossing and flies on for the rest of the substep.
template <class Real>
void Bounce(const Substep<Real>& substep, const Surface<Real>& surface, Real friction, Real restitution, Real crossing,
            Vector3<Real>& x, Vector3<Real>& v) {
  const Flight<Real> at = substep.At(crossing);
  const Vector3<Real> normal = FindSurfacePoint(surface, at.x).normal;
  const Real approach = -normal.dot(at.v);
  const Real kick = (Real(1) + restitution) * approach;
  const Vector3<Real> after = at.v + kick * normal - FindSlowing(at.v, normal, friction, kick);
  const Real left = (Real(1) - crossing) * substep.h;
  const Vector3<Real> acceleration = (substep.end.v - substep.begin.v) / substep.h;
  v = after + left * acceleration;
  x = at.x + left * (after + (left / Real(2)) * acceleration);
  Lift(surface, x, v);
}

// The vertex stays on the surface from the crossing on.
template <class Real>
void Rest(const Substep<Real>& substep, const Surface<Real>& surface, Real friction, Real crossing, Vector3<Real>& x,
          Vector3<Real>& v) {
  const Vector3<Real> normal = FindSurfacePoint(surface, x).normal;
  const Real kick = std::max(Real(0), -normal.dot(v));
  const Vector3<Real> slowing = FindSlowing(v, normal, friction, kick);
  v -= slowing;
  x -= ((Real(1) - crossing) * substep.h / Real(2)) * slowing;
  Lift(surface, x, v);
}

// Ends a slide that friction has stopped within the substep: friction cannot reverse it. before: the slip at the
// beginning of the substep, m/s.
template <class Real>
void StopSlide(Real h, const Vector3<Real>& before, const Vector3<Real>& normal, Vector3<Real>& x, Vector3<Real>& v) {
  const Vector3<Real> slip = RemoveNormalPart<Real>(v, normal);
  if (before.isZero(0) || slip.dot(before) > Real(0)) return;
  const Real was = std::sqrt(before.dot(before));
  const Real is = std::sqrt(slip.dot(slip));
  v -= slip;
  x -= (h / Real(2) * is / (was + is)) * slip;  // the way back since then
}

// Puts one vertex back that is below the surface. True if it lies on the surface afterwards.
template <class Real>
bool PutBack(const ContactParameters<Real>& parameters, const Substep<Real>& substep, const Surface<Real>& surface,
             Vector3<Real>& x, Vector3<Real>& v) {
  const Real friction = parameters.friction * surface.friction;
  const Real crossing = FindCrossing(surface, substep);
  const Flight<Real> at = substep.At(crossing);
  const Vector3<Real> normal = FindSurfacePoint(surface, at.x).normal;
  const Real approach = -normal.dot(at.v);
  const Real gained = std::max(Real(0), normal.dot(substep.begin.v) - normal.dot(substep.end.v));
  if (approach > std::max(static_cast<Real>(kRestingSpeed), static_cast<Real>(kRestingSteps) * gained)) {
    Bounce(substep, surface, friction, parameters.restitution, crossing, x, v);
    return false;
  }
  Rest(substep, surface, friction, crossing, x, v);
  return true;
}

}  // namespace

template <class Real>
void PutBack(const Coefficients<Real>& body, Real h, std::span<const Surface<Real>> surfaces,
             std::span<const Vector3<Real>> x0, std::span<const Vector3<Real>> v0, std::span<Contact<Real>> contacts,
             std::span<Vector3<Real>> x, std::span<Vector3<Real>> v) {
  for (Contact<Real>& contact : contacts) {
    const std::uint32_t i = contact.vertex;
    if (contact.buried || !(body.inverseMasses[i] > Real(0))) continue;
    const Surface<Real>& surface = surfaces[contact.surface];
    const SurfacePoint<Real> point = FindSurfacePoint(surface, x[i]);
    if (contact.touching) {
      StopSlide<Real>(h, contact.slip, point.normal, x[i], v[i]);
      contact.touching = point.distance <= static_cast<Real>(kLyingDistance);
    } else if (point.distance < Real(0)) {
      contact.touching = PutBack<Real>(body.contact, {h, {x0[i], v0[i]}, {x[i], v[i]}}, surface, x[i], v[i]);
    }
  }
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (const Contact<Real>& contact : contacts) {
      const std::uint32_t i = contact.vertex;
      if (!contact.buried && body.inverseMasses[i] > Real(0)) Lift(surfaces[contact.surface], x[i], v[i]);
    }
  }
  for (Contact<Real>& contact : contacts) {
    if (!contact.touching) continue;
    const Vector3<Real> normal = FindSurfacePoint(surfaces[contact.surface], x[contact.vertex]).normal;
    contact.slip = RemoveNormalPart<Real>(v[contact.vertex], normal);
    if (contact.slip.dot(contact.slip) > static_cast<Real>(kStuckSpeed * kStuckSpeed)) continue;
    v[contact.vertex] -= contact.slip;
    contact.slip.setZero();
  }
}

template <class Real>
void HoldResting(const Coefficients<Real>& body, std::span<const Surface<Real>> surfaces,
                 std::span<const Contact<Real>> contacts, std::span<const Vector3<Real>> x,
                 std::span<Vector3<Real>> accelerations) {
  for (const Contact<Real>& contact : contacts) {
    if (!contact.touching) continue;
    const Surface<Real>& surface = surfaces[contact.surface];
    const SurfacePoint<Real> point = FindSurfacePoint(surface, x[contact.vertex]);
    Vector3<Real>& a = accelerations[contact.vertex];
    const Real pressed = -point.normal.dot(a);
    if (point.distance > static_cast<Real>(kLyingDistance) || !(pressed > Real(0))) continue;
    a += pressed * point.normal;
    const Real limit = body.contact.friction * surface.friction * pressed;
    const Real slipSpeed = std::sqrt(contact.slip.dot(contact.slip));
    const Real along = std::sqrt(a.dot(a));
    if (slipSpeed > Real(0)) {
      a -= (limit / slipSpeed) * contact.slip;
    } else if (along > Real(0)) {
      a -= std::min(Real(1), limit / along) * a;
    }
  }
}

#define WOBBLE_INSTANTIATE(Real)                                                                  \
  template void HoldResting<Real>(const Coefficients<Real>&, std::span<const Surface<Real>>,      \
                                  std::span<const Contact<Real>>, std::span<const Vector3<Real>>, \
                                  std::span<Vector3<Real>>);                                      \
  template void PutBack<Real>(const Coefficients<Real>&, Real, std::span<const Surface<Real>>,    \
                              std::span<const Vector3<Real>>, std::span<const Vector3<Real>>,     \
                              std::span<Contact<Real>>, std::span<Vector3<Real>>, std::span<Vector3<Real>>);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
