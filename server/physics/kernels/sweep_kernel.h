// The sweep of packs (sweep.h). Compiled once for each instruction set.
#pragma once

#include "server/physics/kernels/contact/body_contact_kernel.h"
#include "server/physics/kernels/contact/contact_kernel.h"
#include "server/physics/kernels/contact/plane_kernel.h"
#include "server/physics/kernels/contact/point_kernel.h"
#include "server/physics/kernels/grid_kernel.h"
#include "server/physics/kernels/rare_terms.h"
#include "server/physics/kernels/solid_terms.h"
#include "server/physics/kernels/sweep.h"
#include "server/physics/kernels/terms.h"
#include "server/physics/lanes/lanes.h"

namespace wobble::physics {
namespace {

#define WOBBLE_INLINE static inline __attribute__((always_inline))

// The pressure over `times`. times: the ratio of the summed volume to the true one, and of a ring's cross products to a
// vertex's share of the area: 6 for both, in an outline 2 for both.
template <class V, class Real>
WOBBLE_INLINE V FindPressureShare(const SweepTables<Real>& tables, const SweepLanes<Real>& lanes, Real times) {
  const V volume = *reinterpret_cast<const V*>(lanes.sixVolume) / Spread<V>(times);
  const V bounded = Max(volume, Spread<V>(tables.floorVolume));
  // ComputePressure: nRT/B (2 − max(V, 0)/B) with B = max(V, floor), which above the floor is nRT/V.
  const V gas = *reinterpret_cast<const V*>(lanes.gas);
  const V pressure = gas / bounded * (Spread<V>(Real(2)) - Max(volume, Spread<V>(Real(0))) / bounded);
  return (pressure - Spread<V>(tables.ambientPressure)) / Spread<V>(times);
}

template <class V>
WOBBLE_INLINE V AddSixVolume(const Wedge& wedge, const V* last, const V* from, V sum) {
  const V* before = from + wedge.before;
  const V* middle = from + wedge.middle;
  const V* after = from + wedge.after;
  const V u = after[0] - before[0];
  const V v = after[1] - before[1];
  const V w = after[2] - before[2];
  const V x = Fms(middle[1], w, middle[2] * v);
  const V y = Fms(middle[2], u, middle[0] * w);
  const V z = Fms(middle[0], v, middle[1] * u);
  return sum + Fma(last[0], x, Fma(last[1], y, last[2] * z));
}

template <class V, class Real>
WOBBLE_INLINE void AddArcs(const Arc<Real>* arc, const Arc<Real>* end, const V* from, const V* own, V factor,
                           V* pending, Vector3Of<V>& force) {
  for (; arc != end; ++arc) {
    const Vector3Of<V> pull = FindPull<Real>(FindEnds(own, from + arc->other), Spread<V>(arc->stiffness),
                                             Spread<V>(arc->stiffnessAtRest), Spread<V>(arc->damping), factor);
    V* onOther = pending + arc->pending;
    force.x = force.x - pull.x;
    force.y = force.y - pull.y;
    force.z = force.z - pull.z;
    onOther[0] = onOther[0] + pull.x;
    onOther[1] = onOther[1] + pull.y;
    onOther[2] = onOther[2] + pull.z;
  }
}

template <class V, class Real>
WOBBLE_INLINE void AddGasOfRing(const std::uint32_t* ring, const std::uint32_t* end, const V* from, const V* own,
                                V pressureShare, Vector3Of<V>& force) {
  if (ring == end) return;
  const V* before = from + end[-1];
  V ax = Spread<V>(Real(0));
  V ay = ax;
  V az = ax;
  for (; ring != end; ring += 2) {
    const V* middle = from + ring[0];
    const V* after = from + ring[1];
    const V ux = own[0] - middle[0];  // with the sign reversed, so that each term takes one instruction
    const V uy = own[1] - middle[1];
    const V uz = own[2] - middle[2];
    const V wx = after[0] - before[0];
    const V wy = after[1] - before[1];
    const V wz = after[2] - before[2];
    ax = Fnma(uy, wz, Fma(uz, wy, ax));
    ay = Fnma(uz, wx, Fma(ux, wz, ay));
    az = Fnma(ux, wy, Fma(uy, wx, az));
    before = after;
  }
  force.x = Fma(pressureShare, ax, force.x);
  force.y = Fma(pressureShare, ay, force.y);
  force.z = Fma(pressureShare, az, force.z);
}

// Reads the pending force of a place and sets it to zero.
template <class V, class Real>
WOBBLE_INLINE Vector3Of<V> TakePending(V* pending) {
  const Vector3Of<V> force{pending[0], pending[1], pending[2]};
  pending[0] = pending[1] = pending[2] = Spread<V>(Real(0));
  return force;
}

template <class V, class Real>
WOBBLE_INLINE void DivideByMass(Real perMass, bool planar, const V* given, Vector3Of<V>& force) {
  const V inverseMass = Spread<V>(perMass);
  force.x = Fma(force.x, inverseMass, given[0]);
  force.y = Fma(force.y, inverseMass, given[1]);
  force.z = Fma(force.z, inverseMass, given[2]);
  if (planar) force.y = Spread<V>(Real(0));
  if (perMass == Real(0)) force.x = force.y = force.z = Spread<V>(Real(0));
}

// Gas, Outer: whether the instance has these terms. Rare: it has all terms, and reads at run time which are needed.
template <int Stage, bool Gas, bool Outer, bool Rare, class V, class Real>
void SweepOnce(const SweepTables<Real>& ofBlueprint, SweepLanes<Real>& ofPack, Real step) {
  // Copies that no other pointer can reach: otherwise each store to an array would make the compiler reload the
  // pointers.
  const SweepTables<Real> tables = ofBlueprint;
  const SweepLanes<Real> lanes = ofPack;
  const V* from = reinterpret_cast<const V*>(Stage == 0 ? lanes.state : lanes.stage);
  V* to = reinterpret_cast<V*>(Stage == 3 ? lanes.state : lanes.nextStage);
  V* pending = reinterpret_cast<V*>(lanes.pending);
  const V factor = *reinterpret_cast<const V*>(lanes.stiffnessFactors);
  const V weight = Spread<V>(Stage == 0 || Stage == 3 ? step / 6 : step / 3);
  const V reach = Spread<V>(Stage == 2 ? step : step / 2);
  V pressureShare = Spread<V>(Real(0));
  const bool hasVolume = Gas && (!Rare || tables.hasGas);
  const bool hasArea = Rare && tables.hasOutline;
  if (hasVolume || hasArea) pressureShare = FindPressureShare<V>(tables, lanes, Real(hasArea ? 2 : 6));
  V sixVolume = Spread<V>(Real(0));
  V errors[kErrorSums];
  if constexpr (Stage == 0 || Stage == 3) Clear(errors);
  const V* given = reinterpret_cast<const V*>(lanes.acceleration);
  const Arc<Real>* arc = tables.arcs;
  const std::uint32_t* ring = tables.ring;
  const Wedge* wedge = tables.wedges;
  [[maybe_unused]] const DraggedFace* face = tables.draggedFaces;
  [[maybe_unused]] const Element<Real>* element = tables.elements;
  [[maybe_unused]] const HingeArc<Real>* hinge = tables.hinges;
  for (std::uint32_t i = 0; i < tables.count; ++i) {
    const SweepPlace<Real>& place = tables.places[i];
    const V* source = from + 6 * i;
    const V own[6] = {source[0], source[1], source[2], source[3], source[4], source[5]};
    Vector3Of<V> force = TakePending<V, Real>(pending + 3 * (i & tables.pendingMask));
    const Arc<Real>* arcEnd = tables.arcs + place.arcEnd;
    const std::uint32_t* ringEnd = tables.ring + place.ringEnd;
    if constexpr (Rare) {
      const auto begin = static_cast<std::uint32_t>(arc - tables.arcs);
      AddRareArcs(tables, lanes, begin, place.arcEnd, from, own, pending, force);
      const DraggedFace* faceEnd = tables.draggedFaces + tables.draggedEnds[i];
      AddDragOfFaces(tables, lanes, face, faceEnd, from, own, pending, force);
      face = faceEnd;
      if (tables.elementEnds != nullptr) {
        const Element<Real>* elementEnd = tables.elements + tables.elementEnds[i];
        AddElements(tables, lanes, element, elementEnd, from, own, pending, force);
        element = elementEnd;
      }
      if (tables.hingeEnds != nullptr) {
        const HingeArc<Real>* hingeEnd = tables.hinges + tables.hingeEnds[i];
        AddHingeArcs(tables, lanes, hinge, hingeEnd, from, own, pending, force);
        hinge = hingeEnd;
      }
      if (hasArea) AddGasOfOutline(ring, ringEnd, from, pressureShare, force);
    } else {
      AddArcs(arc, arcEnd, from, own, factor, pending, force);
    }
    if (hasVolume) AddGasOfRing<V, Real>(ring, ringEnd, from, own, pressureShare, force);
    arc = arcEnd;
    ring = ringEnd;
    if constexpr (Outer) {
      if ((!Rare || lanes.outer != nullptr) && lanes.hasOuter[i] != 0) {
        const V* outer = reinterpret_cast<const V*>(lanes.outer) + 3 * i;
        force.x = force.x + outer[0];
        force.y = force.y + outer[1];
        force.z = force.z + outer[2];
      }
    }
    DivideByMass(place.inverseMass, tables.planar, given, force);
    V* next = to + 6 * i;
    Advance<Stage>(reinterpret_cast<const V*>(lanes.state) + 6 * i, reinterpret_cast<V*>(lanes.increments) + 6 * i,
                   next, 1, own, force, weight, reach, errors[i % kErrorSums]);
    if constexpr (Gas) {
      for (const Wedge* end = tables.wedges + place.wedgeEnd; wedge != end; ++wedge) {
        sixVolume = hasArea ? AddTwiceArea(*wedge, next, to, sixVolume) : AddSixVolume(*wedge, next, to, sixVolume);
      }
    }
  }
  if constexpr (Gas) *reinterpret_cast<V*>(lanes.sixVolume) = sixVolume;
  if constexpr (Stage == 0) *reinterpret_cast<V*>(lanes.accelerationErrors) = AddUp(errors);
  if constexpr (Stage == 3) *reinterpret_cast<V*>(lanes.velocityErrors) = AddUp(errors);
  if constexpr (Stage < 3) {
    ofPack.stage = lanes.nextStage;
    ofPack.nextStage = lanes.stage;
  }
}

template <int Stage, class V, class Real>
void SweepStage(const SweepTables<Real>& tables, SweepLanes<Real>& lanes, Real step) {
  if (tables.isRare) {
    SweepOnce<Stage, true, true, true, V>(tables, lanes, step);
  } else if (lanes.outer != nullptr) {
    tables.hasGas ? SweepOnce<Stage, true, true, false, V>(tables, lanes, step)
                  : SweepOnce<Stage, false, true, false, V>(tables, lanes, step);
  } else {
    tables.hasGas ? SweepOnce<Stage, true, false, false, V>(tables, lanes, step)
                  : SweepOnce<Stage, false, false, false, V>(tables, lanes, step);
  }
}

template <class V, class Real>
void ComputeSixVolume(const SweepTables<Real>& tables, SweepLanes<Real>& lanes) {
  const V* x = reinterpret_cast<const V*>(lanes.state);
  V sum = Spread<V>(Real(0));
  const Wedge* end = tables.wedges + tables.places[tables.count - 1].wedgeEnd;
  for (const Wedge* wedge = tables.wedges; wedge != end; ++wedge) {
    const V* last = x + wedge->last;
    sum = tables.hasOutline ? AddTwiceArea(*wedge, last, x, sum) : AddSixVolume(*wedge, last, x, sum);
  }
  *reinterpret_cast<V*>(lanes.sixVolume) = sum;
}

template <class Real, int W>
SweepKernel<Real> MakeKernel() {
  using V = typename LanesOf<Real, W>::Type;
  return {
      .width = W,
      .stages = {&SweepStage<0, V, Real>, &SweepStage<1, V, Real>, &SweepStage<2, V, Real>, &SweepStage<3, V, Real>},
      .computeVolume = &ComputeSixVolume<V, Real>,
      .computeContacts = &ComputePenaltyForces<V, Real>,
      .bodyContacts = {.computeForces = &ComputeBodyContactForces<V, Real>, .update = &UpdateBodyContactBlock<V, Real>},
      .gridStages = {&SweepGrid<0, V, Real>, &SweepGrid<1, V, Real>, &SweepGrid<2, V, Real>, &SweepGrid<3, V, Real>},
      .points = {.findWithin = &FindPointsWithin<V, Real>, .findNearest = &FindNearestPoint<V, Real>},
      .planes = {.addForces = &AddPlaneForces<V, Real>, .dragAnchors = &DragPlaneAnchors<V, Real>}};
}

#undef WOBBLE_INLINE

}  // namespace
}  // namespace wobble::physics
