// Contacts of a pack with planes on vectors (plane_lanes.h). Compiled once for each instruction set.
#pragma once

#include "server/physics/kernels/contact/contact_kernel.h"
#include "server/physics/kernels/contact/plane_lanes.h"

#define WOBBLE_INLINE static inline __attribute__((always_inline))

namespace wobble::physics {
namespace {

template <class V>
struct PlanePoint {
  V x[3];
  V normal[3];
  V distance;
};

template <class V, class Real>
WOBBLE_INLINE V ReadLanes(const Real* from) {
  return *reinterpret_cast<const V*>(from);
}

template <class V, class Real>
WOBBLE_INLINE PlanePoint<V> FindPlanePoint(const PlaneLanes<Real>& planes, std::uint32_t slot, const Real* numbers,
                                           std::uint32_t lane) {
  PlanePoint<V> point;
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    point.x[axis] = ReadLanes<V>(numbers + axis * planes.width);
    point.normal[axis] = Spread<V>(planes.slots[slot].normal[axis]);
  }
  const V height = Fma(point.normal[2], point.x[2], Fma(point.normal[1], point.x[1], point.normal[0] * point.x[0]));
  point.distance = height - ReadLanes<V>(planes.offsets + slot * planes.width + lane);
  return point;
}

// The stick spring: the tangential part of the way from the anchor, m.
template <class V, class Real>
WOBBLE_INLINE void FindPlaneSlip(const PlaneLanes<Real>& planes, const PlanePoint<V>& point, const Real* anchors,
                                 V* slip) {
  V way[3];
  for (std::uint32_t axis = 0; axis < 3; ++axis) {
    way[axis] = point.x[axis] - ReadLanes<V>(anchors + axis * planes.width);
  }
  FindSlip(point.normal, way, slip);
}

// The outer forces of a place; zeroed and listed at its first use.
template <class Real>
WOBBLE_INLINE Real* FindOuter(OuterLanes<Real>& outer, std::uint32_t place, std::uint32_t width) {
  Real* forces = outer.forces + 3 * place * width;
  if (outer.hasForce[place] == 0) {
    for (std::uint32_t i = 0; i < 3 * width; ++i) forces[i] = Real(0);
    outer.hasForce[place] = 1;
    outer.places[outer.count++] = place;
  }
  return forces;
}

template <class V, class Real>
void AddPlaneForces(const PenaltyLaw<Real>& law, const PlaneLanes<Real>& planes, const Real* state,
                    OuterLanes<Real>& outer) {
  constexpr std::uint32_t kWidth = sizeof(V) / sizeof(Real);
  const PenaltyLaw<V> everywhere = SpreadLaw<V>(law);
  const V zero = Spread<V>(Real(0));
  const std::uint32_t width = planes.width;
  for (std::uint32_t slot = 0; slot < planes.count; ++slot) {
    const std::uint32_t place = planes.slots[slot].place;
    for (std::uint32_t lane = 0; lane < width; lane += kWidth) {
      const Real* numbers = state + 6 * place * width + lane;
      const PlanePoint<V> point = FindPlanePoint<V>(planes, slot, numbers, lane);
      if (FindBelow(point.distance, zero) == 0) continue;
      V v[3];
      for (std::uint32_t axis = 0; axis < 3; ++axis) v[axis] = ReadLanes<V>(numbers + (3 + axis) * width);
      V slip[3];
      V force[3];
      FindPlaneSlip(planes, point, planes.anchors + 3 * slot * width + lane, slip);
      FindContactForce<Real>(everywhere, point.normal, point.distance, v, slip,
                             ReadLanes<V>(planes.sticks + slot * width + lane), Spread<V>(planes.slots[slot].friction),
                             force);
      const V share = ReadLanes<V>(planes.shares + slot * width + lane);
      Real* to = FindOuter(outer, place, width) + lane;
      for (std::uint32_t axis = 0; axis < 3; ++axis) {
        V* sum = reinterpret_cast<V*>(to + axis * width);
        *sum = *sum + share * force[axis];
      }
    }
  }
}

template <class V, class Real>
void DragPlaneAnchors(const PenaltyLaw<Real>& law, Real stick, Real h, const PlaneLanes<Real>& planes,
                      const Real* state) {
  constexpr std::uint32_t kWidth = sizeof(V) / sizeof(Real);
  const PenaltyLaw<V> everywhere = SpreadLaw<V>(law);
  const V zero = Spread<V>(Real(0));
  const std::uint32_t width = planes.width;
  for (std::uint32_t slot = 0; slot < planes.count; ++slot) {
    for (std::uint32_t lane = 0; lane < width; lane += kWidth) {
      const Real* numbers = state + 6 * planes.slots[slot].place * width + lane;
      const PlanePoint<V> point = FindPlanePoint<V>(planes, slot, numbers, lane);
      V& set = *reinterpret_cast<V*>(planes.sticks + slot * width + lane);
      const V before = set;
      set = point.distance < zero ? Spread<V>(stick) : zero;
      if (FindBelow(point.distance, zero) == 0) continue;
      Real* anchors = planes.anchors + 3 * slot * width + lane;
      V slip[3];
      const V depth = Max(-point.distance, zero);
      FindPlaneSlip(planes, point, anchors, slip);
      const std::uint32_t begins = FindBelow(before, Spread<V>(stick)) & FindBelow(zero, depth);
      if (begins != 0) {
        V v[3];
        V first[3];
        for (std::uint32_t axis = 0; axis < 3; ++axis) v[axis] = ReadLanes<V>(numbers + (3 + axis) * width);
        FindFirstSlip<Real>(h, depth, point.normal, v, first);
        for (int axis = 0; axis < 3; ++axis) slip[axis] = before > zero ? slip[axis] : first[axis];
      }
      // Most contacts stick: nothing to do for them. Lanes without contact have no stick spring, so nothing pulls.
      const V limit = Spread<V>(planes.slots[slot].friction) * FindSpringForce<Real>(everywhere, depth);
      const V squareLimit = limit * limit;
      const V square = Dot(slip, slip);
      const V squarePull = set * set * square;
      const std::uint32_t drags = FindBelow(squareLimit, squarePull);
      if ((begins | drags) == 0) continue;
      const V kept = limit / Max(set * Sqrt(square), Spread<V>(Real(1e-30F)));
      for (std::uint32_t axis = 0; axis < 3; ++axis) {
        V& anchor = *reinterpret_cast<V*>(anchors + axis * width);
        const V held = before > zero ? anchor : point.x[axis] - slip[axis];
        anchor = squareLimit < squarePull ? Fnma(slip[axis], kept, point.x[axis]) : held;
      }
    }
  }
}

}  // namespace
}  // namespace wobble::physics

#undef WOBBLE_INLINE
