// The sweep itself, for the translation units that compile it for one instruction set each.
#pragma once

#include "server/physics/lanes/body_contact_kernel.h"
#include "server/physics/lanes/contact_kernel.h"
#include "server/physics/lanes/lanes.h"
#include "server/physics/lanes/point_kernel.h"
#include "server/physics/lanes/sweep.h"

namespace wobble::physics {
namespace {

template <class V>
struct Vector3Of {
  V x, y, z;
};

// Below this two vertices are in one place: there is no direction to push in. m².
inline constexpr float kLeastSquare = 1e-30F;

#define WOBBLE_INLINE static inline __attribute__((always_inline))

template <class V, class Real>
WOBBLE_INLINE V FindPressureShare(const SweepTables<Real>& tables, const SweepLanes<Real>& lanes) {
  const V volume = *reinterpret_cast<const V*>(lanes.sixVolume) / Spread<V>(Real(6));
  const V bounded = Max(volume, Spread<V>(tables.floorVolume));
  // (nRT/V)(2 − V/V) is nRT/V, and below the floor its tangent.
  const V gas = *reinterpret_cast<const V*>(lanes.gas);
  const V pressure = gas / bounded * (Spread<V>(Real(2)) - volume / bounded);
  return (pressure - Spread<V>(tables.ambientPressure)) / Spread<V>(Real(6));
}

template <class V>
WOBBLE_INLINE V AddSixVolume(const V* a, const V* b, const V* c, V sum) {
  const V x = Fma(b[1], c[2], -(b[2] * c[1]));
  const V y = Fma(b[2], c[0], -(b[0] * c[2]));
  const V z = Fma(b[0], c[1], -(b[1] * c[0]));
  return Fma(a[0], x, Fma(a[1], y, Fma(a[2], z, sum)));
}

template <class V, class Real>
WOBBLE_INLINE void AddArcs(const SweepTables<Real>& tables, std::uint32_t place, const V* from, const V* own, V factor,
                           V* pending, Vector3Of<V>& force) {
  for (std::uint32_t i = tables.arcBegins[place]; i < tables.arcBegins[place + 1]; ++i) {
    const Arc<Real>& arc = tables.arcs[i];
    const V* other = from + 6 * arc.other;
    const V lx = own[0] - other[0];
    const V ly = own[1] - other[1];
    const V lz = own[2] - other[2];
    const V square = Max(Fma(lz, lz, Fma(ly, ly, lx * lx)), Spread<V>(Real(kLeastSquare)));
    const V rate = Fma(lz, own[5] - other[5], Fma(ly, own[4] - other[4], lx * (own[3] - other[3])));
    const V inverse = Spread<V>(Real(1)) / Sqrt(square);
    const V damped = Fma(Spread<V>(arc.damping) * rate, inverse, -Spread<V>(arc.stiffnessAtRest));
    const V tension = factor * Fma(damped, inverse, Spread<V>(arc.stiffness));
    V* onOther = pending + 3 * (arc.other & tables.pendingMask);
    const V px = tension * lx;
    const V py = tension * ly;
    const V pz = tension * lz;
    force.x = force.x - px;
    force.y = force.y - py;
    force.z = force.z - pz;
    onOther[0] = onOther[0] + px;
    onOther[1] = onOther[1] + py;
    onOther[2] = onOther[2] + pz;
  }
}

template <class V, class Real>
WOBBLE_INLINE void AddGasOfRing(const SweepTables<Real>& tables, std::uint32_t place, const V* from, const V* own,
                                V pressureShare, Vector3Of<V>& force) {
  const std::uint32_t end = tables.ringBegins[place + 1];
  std::uint32_t i = tables.ringBegins[place];
  const V* last = from + 6 * tables.ring[end - 1];
  V ux = last[0] - own[0];
  V uy = last[1] - own[1];
  V uz = last[2] - own[2];
  V ax = Spread<V>(Real(0));
  V ay = ax;
  V az = ax;
  for (; i < end; ++i) {
    const V* next = from + 6 * tables.ring[i];
    const V wx = next[0] - own[0];
    const V wy = next[1] - own[1];
    const V wz = next[2] - own[2];
    ax = Fma(uy, wz, Fnma(uz, wy, ax));
    ay = Fma(uz, wx, Fnma(ux, wz, ay));
    az = Fma(ux, wy, Fnma(uy, wx, az));
    ux = wx;
    uy = wy;
    uz = wz;
  }
  force.x = Fma(pressureShare, ax, force.x);
  force.y = Fma(pressureShare, ay, force.y);
  force.z = Fma(pressureShare, az, force.z);
}

// Takes what has come together for the place, leaving nothing.
template <class V, class Real>
WOBBLE_INLINE Vector3Of<V> TakePending(V* pending) {
  const Vector3Of<V> force{pending[0], pending[1], pending[2]};
  pending[0] = pending[1] = pending[2] = Spread<V>(Real(0));
  return force;
}

template <class V, class Real>
WOBBLE_INLINE void DivideByMass(const SweepTables<Real>& tables, const SweepLanes<Real>& lanes, std::uint32_t place,
                                Vector3Of<V>& force) {
  const V* given = reinterpret_cast<const V*>(lanes.acceleration);
  const V inverseMass = Spread<V>(tables.inverseMasses[place]);
  force.x = Fma(force.x, inverseMass, given[0]);
  force.y = Fma(force.y, inverseMass, given[1]);
  force.z = Fma(force.z, inverseMass, given[2]);
  if (tables.planar) force.y = Spread<V>(Real(0));
  if (tables.inverseMasses[place] == Real(0)) force.x = force.y = force.z = Spread<V>(Real(0));
}

// Stage 0 … 3 of the classic tableau: what it adds to the step, and where the next stage stands. The last one completes
// the step, whose new state is nextStage's then.
template <int Stage, class V, class Real>
WOBBLE_INLINE void Advance(const SweepLanes<Real>& lanes, std::uint32_t place, const V* own, const Vector3Of<V>& a,
                           V weight, V reach, V* next, V& errors) {
  V* sum = reinterpret_cast<V*>(lanes.increments) + 6 * place;
  const V* begin = reinterpret_cast<const V*>(lanes.state) + 6 * place;
  if constexpr (Stage == 0) {
    const V jumpX = sum[0] - a.x;
    const V jumpY = sum[1] - a.y;
    const V jumpZ = sum[2] - a.z;
    errors = Fma(jumpX, jumpX, Fma(jumpY, jumpY, Fma(jumpZ, jumpZ, errors)));
    for (int k = 0; k < 3; ++k) sum[k] = weight * own[k + 3];
    sum[3] = weight * a.x;
    sum[4] = weight * a.y;
    sum[5] = weight * a.z;
  } else if constexpr (Stage < 3) {
    for (int k = 0; k < 3; ++k) sum[k] = Fma(weight, own[k + 3], sum[k]);
    sum[3] = Fma(weight, a.x, sum[3]);
    sum[4] = Fma(weight, a.y, sum[4]);
    sum[5] = Fma(weight, a.z, sum[5]);
  }
  if constexpr (Stage < 3) {
    for (int k = 0; k < 3; ++k) next[k] = Fma(reach, own[k + 3], begin[k]);
    next[3] = Fma(reach, a.x, begin[3]);
    next[4] = Fma(reach, a.y, begin[4]);
    next[5] = Fma(reach, a.z, begin[5]);
  } else {
    for (int k = 0; k < 3; ++k) next[k] = begin[k] + Fma(weight, own[k + 3], sum[k]);
    next[3] = begin[3] + Fma(weight, a.x, sum[3]);
    next[4] = begin[4] + Fma(weight, a.y, sum[4]);
    next[5] = begin[5] + Fma(weight, a.z, sum[5]);
    for (int k = 3; k < 6; ++k) {
      const V error = own[k] - next[k];
      errors = Fma(error, error, errors);
    }
    sum[0] = a.x;
    sum[1] = a.y;
    sum[2] = a.z;
  }
}

template <int Stage, bool Gas, bool Outer, class V, class Real>
void SweepOnce(const SweepTables<Real>& ofBlueprint, SweepLanes<Real>& ofPack, Real step) {
  // Copies that nothing else can point to: stores into the arrays would make the compiler read the pointers again.
  const SweepTables<Real> tables = ofBlueprint;
  const SweepLanes<Real> lanes = ofPack;
  const V* from = reinterpret_cast<const V*>(Stage == 0 ? lanes.state : lanes.stage);
  V* to = reinterpret_cast<V*>(Stage == 3 ? lanes.state : lanes.nextStage);
  V* pending = reinterpret_cast<V*>(lanes.pending);
  const V factor = *reinterpret_cast<const V*>(lanes.stiffnessFactors);
  const V weight = Spread<V>(Stage == 0 || Stage == 3 ? step / 6 : step / 3);
  const V reach = Spread<V>(Stage == 2 ? step : step / 2);
  V pressureShare = Spread<V>(Real(0));
  if constexpr (Gas) pressureShare = FindPressureShare<V>(tables, lanes);
  V sixVolume = Spread<V>(Real(0));
  V errors = sixVolume;
  for (std::uint32_t place = 0; place < tables.count; ++place) {
    const V* source = from + 6 * place;
    const V own[6] = {source[0], source[1], source[2], source[3], source[4], source[5]};
    Vector3Of<V> force = TakePending<V, Real>(pending + 3 * (place & tables.pendingMask));
    AddArcs(tables, place, from, own, factor, pending, force);
    if constexpr (Gas) AddGasOfRing(tables, place, from, own, pressureShare, force);
    if constexpr (Outer) {
      if (lanes.hasOuter[place] != 0) {
        const V* outer = reinterpret_cast<const V*>(lanes.outer) + 3 * place;
        force.x = force.x + outer[0];
        force.y = force.y + outer[1];
        force.z = force.z + outer[2];
      }
    }
    DivideByMass(tables, lanes, place, force);
    V* next = to + 6 * place;
    Advance<Stage>(lanes, place, own, force, weight, reach, next, errors);
    if constexpr (Gas) {
      for (std::uint32_t i = tables.faceBegins[place]; i < tables.faceBegins[place + 1]; i += 2) {
        sixVolume = AddSixVolume(next, to + 6 * tables.faces[i], to + 6 * tables.faces[i + 1], sixVolume);
      }
    }
  }
  if constexpr (Gas) *reinterpret_cast<V*>(lanes.sixVolume) = sixVolume;
  if constexpr (Stage == 0) *reinterpret_cast<V*>(lanes.accelerationErrors) = errors;
  if constexpr (Stage == 3) *reinterpret_cast<V*>(lanes.velocityErrors) = errors;
  if constexpr (Stage < 3) {
    ofPack.stage = lanes.nextStage;
    ofPack.nextStage = lanes.stage;
  }
}

template <int Stage, class V, class Real>
void SweepStage(const SweepTables<Real>& tables, SweepLanes<Real>& lanes, Real step) {
  if (lanes.outer != nullptr) {
    tables.hasGas ? SweepOnce<Stage, true, true, V>(tables, lanes, step)
                  : SweepOnce<Stage, false, true, V>(tables, lanes, step);
  } else {
    tables.hasGas ? SweepOnce<Stage, true, false, V>(tables, lanes, step)
                  : SweepOnce<Stage, false, false, V>(tables, lanes, step);
  }
}

template <class V, class Real>
void ComputeSixVolume(const SweepTables<Real>& tables, SweepLanes<Real>& lanes) {
  const V* x = reinterpret_cast<const V*>(lanes.state);
  V sum = Spread<V>(Real(0));
  for (std::uint32_t place = 0; tables.hasGas && place < tables.count; ++place) {
    for (std::uint32_t i = tables.faceBegins[place]; i < tables.faceBegins[place + 1]; i += 2) {
      sum = AddSixVolume(x + 6 * place, x + 6 * tables.faces[i], x + 6 * tables.faces[i + 1], sum);
    }
  }
  *reinterpret_cast<V*>(lanes.sixVolume) = sum;
}

template <class Real, int W>
SweepKernel<Real> MakeKernel() {
  using V = typename LanesOf<Real, W>::Type;
  return {W,
          {&SweepStage<0, V, Real>, &SweepStage<1, V, Real>, &SweepStage<2, V, Real>, &SweepStage<3, V, Real>},
          &ComputeSixVolume<V, Real>,
          &ComputePenaltyForces<V, Real>,
          {&ComputeBodyContactForces<V, Real>, &UpdateBodyContactBlock<V, Real>},
          {&FindPointsWithin<V, Real>, &FindNearestPoint<V, Real>}};
}

#undef WOBBLE_INLINE

}  // namespace
}  // namespace wobble::physics
