#include "server/physics/contact/rod_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace wobble::physics {
namespace {

// A rod with an end deeper in the ground than this has come in from beside it, or is held by its ends, m.
constexpr double kDeepestEnd = 0.05;
// Of a search for the deepest point by golden section: to 0.618²⁴ / 2 of the length. The error of the depth is of
// second order.
constexpr int kSections = 24;
constexpr int kSamplesOfCell = 4;  // of ground along a rod; so many at least
constexpr int kMostSamples = 64;
// Where the distance is no less at this share of a stretch than at its end, it is least at the end: a minimum between
// the two is less deep by (2⁻¹⁰ l)²/8r at most on ground of radius of curvature r, 1e-6 m for l²/r = 8 m.
constexpr double kProbe = 1.0 / 1024;

// What a rod sees of a surface.
template <class Real>
struct RodView {
  Real s = 0;  // of the deepest point, from a to b
  SurfacePoint<Real> point;
  SurfacePoint<Real> end;  // of the deeper end
  bool isEndB = false;
  Real depth = 0;  // D = d − e, m; negative while the rod is outside

  [[nodiscard]] bool IsEndInside() const { return end.distance < Real(0); }  // e > 0
};

// Where along a rod the distance is least, and how large it is there.
template <class Real>
struct Place {
  Real s = 0;
  Real distance = 0;
};

// The distances from a surface along a rod.
template <class Real>
struct RodSearch {
  const Surface<Real>& surface;
  const Vector3<Real>& a;
  const Vector3<Real>& along;

  [[nodiscard]] Real Read(Real s) const { return FindSurfacePoint<Real>(surface, a + s * along).distance; }

  // Whether it is at `end`, where it is atEnd, that the distance is least up to `other`.
  [[nodiscard]] bool IsLeastAt(Real end, Real atEnd, Real other) const {
    return Read(end + static_cast<Real>(kProbe) * (other - end)) >= atEnd;
  }

  // Between s = low and high, where the distance has one minimum.
  [[nodiscard]] Place<Real> FindBetween(Real low, Real high) const {
    constexpr Real kGolden = Real(0.6180339887498949);
    Real left = high - kGolden * (high - low);
    Real right = low + kGolden * (high - low);
    Real atLeft = Read(left);
    Real atRight = Read(right);
    for (int i = 0; i < kSections; ++i) {
      if (atLeft < atRight) {
        high = right;
        right = left;
        atRight = atLeft;
        left = high - kGolden * (high - low);
        atLeft = Read(left);
      } else {
        low = left;
        left = right;
        atLeft = atRight;
        right = low + kGolden * (high - low);
        atRight = Read(right);
      }
    }
    const Real middle = (low + high) / Real(2);
    return {middle, Read(middle)};
  }
};

// The distance from a convex obstacle is a convex function along a line. That from ground is not: it is sampled four
// times a cell, and the search goes on from every sample that is less than its neighbours. From the least sample alone,
// the place leapt to a deeper valley of the distance when another sample became the least: energy from nowhere. Most
// rods are deepest at an end, where a probe takes the place of the search.
template <class Real>
Real FindDeepestPlace(const Surface<Real>& surface, const Vector3<Real>& a, const Vector3<Real>& along) {
  const RodSearch<Real> rod{surface, a, along};
  if (surface.kind != Obstacle::Kind::kHeightField) {
    for (const Real end : {Real(0), Real(1)}) {
      if (rod.IsLeastAt(end, rod.Read(end), Real(1) - end)) return end;
    }
    return rod.FindBetween(0, 1).s;
  }
  const Real level = std::sqrt(along.x() * along.x() + along.y() * along.y());
  const auto cell = static_cast<Real>(surface.field->cellSize);
  const Real wanted = std::ceil(Real(kSamplesOfCell) * level / cell);
  const int samples = wanted > Real(kSamplesOfCell) ? static_cast<int>(std::min(wanted, Real(kMostSamples)))
                                                    : kSamplesOfCell;  // NaN: as few
  const Real step = Real(1) / static_cast<Real>(samples);
  Place<Real> deepest{0, std::numeric_limits<Real>::infinity()};
  Real before = deepest.distance;
  Real here = rod.Read(0);
  for (int i = 0; i <= samples; ++i) {
    const Real after = i < samples ? rod.Read(static_cast<Real>(i + 1) * step) : std::numeric_limits<Real>::infinity();
    if (here <= before && here <= after) {
      const Real low = std::max(Real(0), static_cast<Real>(i - 1) * step);
      const Real high = std::min(Real(1), static_cast<Real>(i + 1) * step);
      const bool isLeast =
          (i == 0 && rod.IsLeastAt(low, here, high)) || (i == samples && rod.IsLeastAt(high, here, low));
      const Place<Real> place = isLeast ? Place<Real>{i == 0 ? low : high, here} : rod.FindBetween(low, high);
      if (place.distance < deepest.distance) deepest = place;
    }
    before = here;
    here = after;
  }
  return deepest.s;
}

template <class Real>
RodView<Real> FindRodView(const Surface<Real>& surface, const Vector3<Real>& a, const Vector3<Real>& b) {
  RodView<Real> view;
  const Vector3<Real> along = b - a;
  view.s = FindDeepestPlace<Real>(surface, a, along);
  view.point = FindSurfacePoint<Real>(surface, a + view.s * along);
  view.end = FindSurfacePoint(surface, a);
  const SurfacePoint<Real> endB = FindSurfacePoint(surface, b);
  view.isEndB = endB.distance < view.end.distance;
  if (view.isEndB) view.end = endB;
  view.depth = std::min(Real(0), view.end.distance) - view.point.distance;
  return view;
}

// Whether all of the rod is farther from the surface than `reach`, by one look at its middle.
template <class Real>
bool IsClear(const Surface<Real>& surface, const Vector3<Real>& a, const Vector3<Real>& b, Real reach) {
  const Vector3<Real> half = (b - a) / Real(2);
  return FindClearance<Real>(surface, a + half) > std::sqrt(half.dot(half)) + reach;
}

// Of ground: with both ends over it, or nearly. A rod that reaches over its border would lie on an edge that is none.
template <class Real>
bool MayMeet(const Surface<Real>& surface, const Vector3<Real>& a, const Vector3<Real>& b) {
  if (surface.kind != Obstacle::Kind::kHeightField) return true;
  const auto isOver = [&](const Vector3<Real>& end) {
    const Real distance = FindSurfacePoint(surface, end).distance;
    return distance > -static_cast<Real>(kDeepestEnd) && distance < static_cast<Real>(kBeyond);
  };
  return isOver(a) && isOver(b);
}

template <class Real>
Real FindRodShare(const Coefficients<Real>& body, const NearRod& rod, Real s) {
  return (Real(1) - s) * body.contactShares[rod.a] + s * body.contactShares[rod.b];
}

// Adds the forces of one rod. vA, vB: velocities of its ends, m/s.
template <class Real>
void AddRodForces(const Coefficients<Real>& body, const Surface<Real>& surface, const RodView<Real>& view, Real share,
                  const Vector3<Real>& vA, const Vector3<Real>& vB, Vector3<Real>& forceA, Vector3<Real>& forceB) {
  const Vector3<Real>& normal = view.point.normal;
  const Vector3<Real> velocity = vA + view.s * (vB - vA);
  Real rate = -normal.dot(velocity);
  if (view.IsEndInside()) rate += view.end.normal.dot(view.isEndB ? vB : vA);
  const Real normalForce = ComputeNormalForce(body.contact, view.depth, rate);
  const Vector3<Real> pull = body.contact.stickDamping * RemoveNormalPart<Real>(velocity, normal);
  const Real limit = body.contact.friction * surface.friction * normalForce;
  const Real strength = std::sqrt(pull.dot(pull));
  const Vector3<Real> force = share * (normalForce * normal - (strength > limit ? limit / strength : Real(1)) * pull);
  forceA += (Real(1) - view.s) * force;
  forceB += view.s * force;
  if (view.IsEndInside()) (view.isEndB ? forceB : forceA) -= (share * normalForce) * view.end.normal;
}

// Calls visit(rod, surface, view) for the rods that push.
template <class Real, class Visit>
void VisitPushing(std::span<const Surface<Real>> surfaces, std::span<const NearRod> rods,
                  std::span<const Vector3<Real>> x, const Visit& visit) {
  for (const NearRod& rod : rods) {
    const Surface<Real>& surface = surfaces[rod.surface];
    if (IsClear<Real>(surface, x[rod.a], x[rod.b], 0)) continue;
    const RodView<Real> view = FindRodView<Real>(surface, x[rod.a], x[rod.b]);
    if (view.depth > Real(0)) visit(rod, surface, view);
  }
}

// Of all rods that have an end in common with this one, and of itself.
ContactRates SumAtEnds(std::span<const NearRod> rods, std::span<const ContactRates> rates, const NearRod& rod) {
  ContactRates sum;
  for (std::size_t i = 0; i < rods.size(); ++i) {
    const NearRod& other = rods[i];
    if (other.a != rod.a && other.a != rod.b && other.b != rod.a && other.b != rod.b) continue;
    sum = sum + rates[i];
  }
  return sum;
}

}  // namespace

template <class Real>
void FindNearRods(const Coefficients<Real>& body, std::span<const std::uint8_t> torn, const SurfaceSearch<Real>& search,
                  std::vector<NearRod>& rods) {
  rods.clear();
  if (!body.faces.empty() || body.contact.law != ContactLaw::kPenalty) return;
  const Bounds<Real>& bounds = search.survey.bounds;
  const Real reach = bounds.speed * search.duration + static_cast<Real>(kNearMargin);
  for (std::uint32_t s = 0; s < search.surfaces.size(); ++s) {
    const Surface<Real>& surface = search.surfaces[s];
    if (surface.kind == Obstacle::Kind::kPlane) continue;
    if (IsClear<Real>(surface, bounds.low, bounds.high, reach)) continue;
    for (std::size_t i = 0; i < body.springs.size(); ++i) {
      const Vector3<Real>& a = search.x[body.springs[i].a];
      const Vector3<Real>& b = search.x[body.springs[i].b];
      const bool isTorn = !torn.empty() && torn[i] != 0;
      if (isTorn || IsClear<Real>(surface, a, b, reach) || !MayMeet<Real>(surface, a, b)) continue;
      rods.push_back({s, static_cast<std::uint16_t>(body.springs[i].a), static_cast<std::uint16_t>(body.springs[i].b)});
    }
  }
}

template <class Real>
void AddRodContacts(const Coefficients<Real>& body, std::span<const Surface<Real>> surfaces,
                    std::span<const NearRod> rods, std::span<const Vector3<Real>> x, std::span<const Vector3<Real>> v,
                    std::span<Vector3<Real>> forces) {
  VisitPushing<Real>(surfaces, rods, x,
                     [&](const NearRod& rod, const Surface<Real>& surface, const RodView<Real>& view) {
                       AddRodForces<Real>(body, surface, view, FindRodShare(body, rod, view.s), v[rod.a], v[rod.b],
                                          forces[rod.a], forces[rod.b]);
                     });
}

template <class Real>
double ComputeRodContactEnergy(const Coefficients<Real>& body, std::span<const Surface<Real>> surfaces,
                               std::span<const NearRod> rods, std::span<const Vector3<Real>> x) {
  double energy = 0;
  VisitPushing<Real>(surfaces, rods, x, [&](const NearRod& rod, const Surface<Real>&, const RodView<Real>& view) {
    energy += double{FindRodShare(body, rod, view.s) * ComputePenaltyEnergy(body.contact, view.depth)};
  });
  return energy;
}

template <class Real>
RodDemands FindRodDemands(const Coefficients<Real>& body, std::span<const Surface<Real>> surfaces,
                          std::span<const NearRod> rods, std::span<const Vector3<Real>> x,
                          std::span<const Vector3<Real>> v, double agitation, double duration,
                          std::vector<ContactRates>& scratch) {
  const double fade = double{body.contact.fadeDepth};
  RodDemands demands;
  scratch.clear();
  for (const NearRod& rod : rods) {
    const Surface<Real>& surface = surfaces[rod.surface];
    const RodView<Real> view = FindRodView<Real>(surface, x[rod.a], x[rod.b]);
    const double approach = double{
        std::max(FindApproach<Real>(surface, view.point, v[rod.a]), FindApproach<Real>(surface, view.point, v[rod.b]))};
    const double depth = double{view.depth};
    const double mass = std::min(double{body.masses[rod.a]} / double{body.contactShares[rod.a]},
                                 double{body.masses[rod.b]} / double{body.contactShares[rod.b]});
    scratch.push_back(FindRates(body.contact, PredictDepth(depth, std::max(agitation, approach), duration), mass));
    const bool lands = depth < fade && PredictDepth(depth, approach, duration) > -fade;
    if (lands) demands.landing = std::max(demands.landing, approach * duration / fade);
  }
  for (const NearRod& rod : rods) {
    const ContactRates sum = SumAtEnds(rods, scratch, rod);
    demands.rates.squareFrequency = std::max(demands.rates.squareFrequency, sum.squareFrequency);
    demands.rates.dampingRate = std::max(demands.rates.dampingRate, sum.dampingRate);
  }
  return demands;
}

#define WOBBLE_INSTANTIATE(Real)                                                                           \
  template void FindNearRods<Real>(const Coefficients<Real>&, std::span<const std::uint8_t>,               \
                                   const SurfaceSearch<Real>&, std::vector<NearRod>&);                     \
  template void AddRodContacts<Real>(const Coefficients<Real>&, std::span<const Surface<Real>>,            \
                                     std::span<const NearRod>, std::span<const Vector3<Real>>,             \
                                     std::span<const Vector3<Real>>, std::span<Vector3<Real>>);            \
  template double ComputeRodContactEnergy<Real>(const Coefficients<Real>&, std::span<const Surface<Real>>, \
                                                std::span<const NearRod>, std::span<const Vector3<Real>>); \
  template RodDemands FindRodDemands<Real>(                                                                \
      const Coefficients<Real>&, std::span<const Surface<Real>>, std::span<const NearRod>,                 \
      std::span<const Vector3<Real>>, std::span<const Vector3<Real>>, double, double, std::vector<ContactRates>&);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
