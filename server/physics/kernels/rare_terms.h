// Terms that few bodies have: repulsion, springs that tear, hinges, drag, gas in an outline; tetrahedra are in
// solid_terms.h.
// One instance of the sweep has all of them and reads from the tables at run time which a body needs; the other
// instances have none.
#pragma once

#include "server/physics/kernels/sweep.h"
#include "server/physics/kernels/terms.h"

namespace wobble::physics {
namespace {

#define WOBBLE_INLINE static inline __attribute__((always_inline))

// AddRepulsion of methods/forces.h as a part of a spring's tension. floor: distance below which it stays constant, m.
template <class V>
WOBBLE_INLINE V FindRepulsion(V repulsion, V length, V inverse, V floor) {
  const V bounded = Max(length, floor);
  const V square = bounded * bounded;
  return repulsion / (square * square) * inverse;
}

// AddDrag of methods/forces.h: the force on each corner of a triangle. share: ½ρC/6, kg/m³.
template <class Real, class V>
WOBBLE_INLINE Vector3Of<V> FindDrag(const V* a, const V* b, const V* c, const V* wind, V share) {
  const V ux = b[0] - a[0];
  const V uy = b[1] - a[1];
  const V uz = b[2] - a[2];
  const V wx = c[0] - a[0];
  const V wy = c[1] - a[1];
  const V wz = c[2] - a[2];
  const V sx = Fms(uy, wz, uz * wy);
  const V sy = Fms(uz, wx, ux * wz);
  const V sz = Fms(ux, wy, uy * wx);
  const V square = Max(Fma(sz, sz, Fma(sy, sy, sx * sx)), Spread<V>(Real(kLeastSquare)));
  const V third = Spread<V>(Real(1) / Real(3));
  const V rx = Fnma(third, a[3] + b[3] + c[3], wind[0]);
  const V ry = Fnma(third, a[4] + b[4] + c[4], wind[1]);
  const V rz = Fnma(third, a[5] + b[5] + c[5], wind[2]);
  const V through = Fma(sz, rz, Fma(sy, ry, sx * rx));
  const V strength = share * Max(through, -through) * through / square;
  return {strength * sx, strength * sy, strength * sz};
}

template <class V>
WOBBLE_INLINE void AddTo(V* sum, const Vector3Of<V>& force) {
  sum[0] = sum[0] + force.x;
  sum[1] = sum[1] + force.y;
  sum[2] = sum[2] + force.z;
}

// AddArcs for the springs from `begin` up to `end`, with repulsion and torn springs.
template <class V, class Real>
void AddRareArcs(const SweepTables<Real>& tables, const SweepLanes<Real>& lanes, std::uint32_t begin, std::uint32_t end,
                 const V* from, const V* own, V* pending, Vector3Of<V>& force) {
  const V factor = *reinterpret_cast<const V*>(lanes.stiffnessFactors);
  const V repulsion = Spread<V>(tables.repulsion);
  for (std::uint32_t i = begin; i < end; ++i) {
    const Arc<Real>& arc = tables.arcs[i];
    const SpringEnds<V> ends = FindEnds(own, from + arc.other);
    const V length = FindLength<Real>(ends.l);
    const V inverse = Spread<V>(Real(1)) / length;
    V tension = factor * FindTension(ends.rate, inverse, Spread<V>(arc.stiffness), Spread<V>(arc.stiffnessAtRest),
                                     Spread<V>(arc.damping));
    if (tables.repulsion > Real(0)) {
      tension = tension - FindRepulsion(repulsion, length, inverse, Spread<V>(tables.repulsionFloors[i]));
    }
    if (lanes.whole != nullptr) tension = tension * reinterpret_cast<const V*>(lanes.whole)[i];
    const Vector3Of<V> pull{tension * ends.l.x, tension * ends.l.y, tension * ends.l.z};
    force = {force.x - pull.x, force.y - pull.y, force.z - pull.z};
    AddTo(pending + arc.pending, pull);
  }
}

// Adds the drag of the faces whose first place is the sweep's.
template <class V, class Real>
void AddDragOfFaces(const SweepTables<Real>& tables, const SweepLanes<Real>& lanes, const DraggedFace* face,
                    const DraggedFace* end, const V* from, const V* own, V* pending, Vector3Of<V>& force) {
  const V* wind = reinterpret_cast<const V*>(lanes.wind);
  for (; face != end; ++face) {
    const Vector3Of<V> drag =
        FindDrag<Real>(own, from + face->others[0], from + face->others[1], wind, Spread<V>(tables.dragShare));
    force = {force.x + drag.x, force.y + drag.y, force.z + drag.z};
    for (const std::uint32_t slot : face->pending) AddTo(pending + slot, drag);
  }
}

// AddHinges of methods/bending.h: what a hinge adds to b and c and takes from a and d. floorSquare: δ₀², m².
template <class Real, class V>
WOBBLE_INLINE Vector3Of<V> FindHingePull(const V* a, const V* b, const V* c, const V* d, V stiffness, V damping,
                                         V floorSquare, V factor) {
  V bend[6];
  for (std::uint32_t k = 0; k < 6; ++k) bend[k] = (a[k] - b[k]) - (c[k] - d[k]);
  const V rate = Fma(bend[2], bend[5], Fma(bend[1], bend[4], bend[0] * bend[3]));
  const V square = Fma(bend[2], bend[2], Fma(bend[1], bend[1], Fma(bend[0], bend[0], floorSquare)));
  const V tension = factor * Fma(damping, rate / square, stiffness);
  return {tension * bend[0], tension * bend[1], tension * bend[2]};
}

// Adds the hinges whose first place is the sweep's, from `hinge` up to `end`. Never inlined, so that bodies without
// hinges carry a call that is not made and nothing else.
template <class V, class Real>
__attribute__((noinline)) void AddHingeArcs(const SweepTables<Real>& tables, const SweepLanes<Real>& lanes,
                                            const HingeArc<Real>* hinge, const HingeArc<Real>* end, const V* from,
                                            const V* own, V* pending, Vector3Of<V>& force) {
  const V factor = *reinterpret_cast<const V*>(lanes.stiffnessFactors);
  const V floorSquare = Spread<V>(tables.hingeFloorSquare);
  for (; hinge != end; ++hinge) {
    const std::uint32_t* others = hinge->others;
    const Vector3Of<V> pull =
        FindHingePull<Real>(own, from + others[0], from + others[1], from + others[2], Spread<V>(hinge->stiffness),
                            Spread<V>(hinge->damping), floorSquare, factor);
    const Vector3Of<V> back{-pull.x, -pull.y, -pull.z};
    force = {force.x - pull.x, force.y - pull.y, force.z - pull.z};
    AddTo(pending + hinge->pending[0], pull);
    AddTo(pending + hinge->pending[1], pull);
    AddTo(pending + hinge->pending[2], back);
  }
}

// The gas pushes a vertex of an outline at right angles to the line between the far ends of its two edges. ring: pairs
// of far ends, the one before and the one after.
template <class V>
WOBBLE_INLINE void AddGasOfOutline(const std::uint32_t* ring, const std::uint32_t* end, const V* from, V pressureShare,
                                   Vector3Of<V>& force) {
  for (; ring != end; ring += 2) {
    const V* before = from + ring[0];
    const V* after = from + ring[1];
    force.x = Fma(pressureShare, after[2] - before[2], force.x);
    force.z = Fnma(pressureShare, after[0] - before[0], force.z);
  }
}

// Adds twice the area between the origin and two edges that meet in `last`.
template <class V>
WOBBLE_INLINE V AddTwiceArea(const Wedge& wedge, const V* last, const V* from, V sum) {
  const V* before = from + wedge.before;
  const V* after = from + wedge.after;
  return sum + Fms(last[0], after[2] - before[2], last[2] * (after[0] - before[0]));
}

#undef WOBBLE_INLINE

}  // namespace
}  // namespace wobble::physics
