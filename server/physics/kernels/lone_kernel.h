// The sweep of a lone body, whose lanes are its springs: with a body a lane, one lane would be used.
//
// Every number has the bits of a lane of a pack: the same formulas (terms.h), every sum in the same order. Springs are
// computed four or eight at a time and their forces added one by one, in the order of the sweep, to a row of each
// vertex; a row is x y z in one register (vertex_rows.h), in which all further terms are computed. Rejected: fetching
// the ends by gather instructions, which costs more than the sums; differences of whole rows, transposed in registers,
// take a third of the instructions.
//
// Solids have an element in each lane (lone_solid.h). Bodies with other rare terms go through the sweep of packs with
// one lane.
//
// Forces are added up where the stage will write its results, in `nextStage`, which nothing reads before.
#pragma once

#include "server/physics/kernels/lone_solid.h"
#include "server/physics/kernels/sweep.h"
#include "server/physics/kernels/sweep_kernel.h"
#include "server/physics/lanes/lanes.h"
#include "server/physics/lanes/vertex_rows.h"

namespace wobble::physics {
namespace {

#define WOBBLE_INLINE static inline __attribute__((always_inline))

// Computes the pulls of as many springs as V has lanes, from `begin` on, as rows.
template <class Real, class V>
WOBBLE_INLINE void FindPulls(const ArcColumns<Real>& columns, std::uint32_t begin, const Real* from, V factor,
                             V (&pulls)[4]) {
  const auto read = [begin](const Real* column) {
    V lanes;
    __builtin_memcpy(&lanes, column + begin, sizeof(V));
    return lanes;
  };
  const std::uint32_t* ends = columns.ends + 2 * begin;
  V l[4];
  V u[4];  // z, then the velocity: so nothing is read beyond the last vertex
  LoadDifferences(from, ends, l);
  LoadDifferences(from + 2, ends, u);
  const V rate = Fma(l[2], u[3], Fma(l[1], u[2], l[0] * u[1]));
  const Vector3Of<V> pull = FindPull<Real, V>({{l[0], l[1], l[2]}, rate}, read(columns.stiffnesses),
                                              read(columns.stiffnessesAtRest), read(columns.dampings), factor);
  pulls[0] = pull.x;
  pulls[1] = pull.y;
  pulls[2] = pull.z;
  pulls[3] = Spread<V>(Real(0));
  Transpose(pulls);
}

template <class Row, class Real>
WOBBLE_INLINE void AddPull(const std::uint32_t* ends, Row pull, Real* forces) {
  Real* onOwn = forces + ends[0];
  Real* onOther = forces + ends[1];
  StoreRow(LoadRow(onOwn) - pull, onOwn);
  StoreRow(LoadRow(onOther) + pull, onOther);
}

// Sets the spring forces on all vertices. forces: six numbers a place, of which the first four are written.
template <class Real>
void ComputePulls(const SweepTables<Real>& tables, const Real* from, Real stiffnessFactor, Real* forces) {
  using V = typename RowsOf<Real>::Lanes;
  using Row = typename RowsOf<Real>::Row;
  constexpr std::uint32_t kWidth = sizeof(V) / sizeof(Real);
  const ArcColumns<Real> columns = tables.columns;
  const V factor = Spread<V>(stiffnessFactor);
  for (std::uint32_t i = 0; i < tables.count; ++i) StoreRow(Spread<Row>(Real(0)), forces + 6 * i);
  const auto addPulls = [&](std::uint32_t begin, std::uint32_t count) {
    V pulls[4];
    FindPulls(columns, begin, from, factor, pulls);
    for (std::uint32_t i = 0; i < count; ++i) {
      AddPull(columns.ends + 2 * (begin + i), FindRow(pulls[i % 4], i >= 4), forces);
    }
  };
  const std::uint32_t rest = tables.arcCount % kWidth;
  const std::uint32_t whole = tables.arcCount - rest;
  for (std::uint32_t begin = 0; begin < whole; begin += kWidth) addPulls(begin, kWidth);
  if (rest > 0) addPulls(whole, rest);
}

// The sum of cross products round the vertex at `own`, as in AddGasOfRing.
template <class Real, class Row>
WOBBLE_INLINE Row FindRingArea(const std::uint32_t* ring, const std::uint32_t* end, const Real* from, Row own) {
  Row area = Spread<Row>(Real(0));
  if (ring == end) return area;
  Row before = LoadRow(from + end[-1]);
  for (; ring != end; ring += 2) {
    const Row after = LoadRow(from + ring[1]);
    const Row u = LoadRow(from + ring[0]) - own;
    const Row w = after - before;
    area = Fma(u, Turn(w), Fnma(Turn(u), w, area));
    before = after;
  }
  return Turn(area);
}

template <class Real>
Real FindSixVolume(const SweepTables<Real>& tables, const Real* x) {
  using Row = typename RowsOf<Real>::Row;
  Real sum = 0;
  const Wedge* end = tables.wedges + tables.places[tables.count - 1].wedgeEnd;
  for (const Wedge* wedge = tables.wedges; wedge != end; ++wedge) {
    const Row middle = LoadRow(x + wedge->middle);
    const Row across = LoadRow(x + wedge->after) - LoadRow(x + wedge->before);
    const Row area = Fms(middle, Turn(across), Turn(middle) * across);  // z x y
    const Real* last = x + wedge->last;
    sum = sum + Fma(last[0], area[1], Fma(last[1], area[2], last[2] * area[0]));
  }
  return sum;
}

template <class Row>
WOBBLE_INLINE auto AddRowSquares(Row row, decltype(row[0] + row[0]) sum) {
  return AddSquares<decltype(sum)>({row[0], row[1], row[2]}, sum);
}

// Advance of terms.h for a vertex's six numbers as a row and a half row.
template <int Stage, class Real, class Row>
WOBBLE_INLINE void AdvanceRow(const Real* begin, Real* sum, Real* next, Row v, Row a, Row weight, Row reach,
                              Real& errors) {
  if constexpr (Stage == 0) errors = AddRowSquares(LoadRow(sum) - a, errors);
  const Row rates = AppendFirst(v, a);
  const Row others = Rotate(a);
  if constexpr (Stage == 0) {
    StoreRow(weight * rates, sum);
    StoreHalf(weight * others, sum + 4);
  } else if constexpr (Stage < 3) {
    StoreRow(Fma(weight, rates, LoadRow(sum)), sum);
    StoreHalf(Fma(weight, others, LoadHalf(sum + 4)), sum + 4);
  }
  if constexpr (Stage < 3) {
    StoreRow(Fma(reach, rates, LoadRow(begin)), next);
    StoreHalf(Fma(reach, others, LoadHalf(begin + 4)), next + 4);
  } else {
    const Row arrived = LoadRow(begin) + Fma(weight, rates, LoadRow(sum));
    const Row rest = LoadHalf(begin + 4) + Fma(weight, others, LoadHalf(sum + 4));
    StoreRow(arrived, next);
    StoreHalf(rest, next + 4);
    errors = AddSquares<Real>({v[0] - arrived[3], v[1] - rest[0], v[2] - rest[1]}, errors);
    StoreRow(a, sum);
  }
}

template <int Stage, bool Gas, class Real>
void SweepAlone(const SweepTables<Real>& ofBlueprint, SweepLanes<Real>& ofBody, Real step) {
  using Row = typename RowsOf<Real>::Row;
  const SweepTables<Real> tables = ofBlueprint;
  const SweepLanes<Real> lanes = ofBody;
  const Real* from = Stage == 0 ? lanes.state : lanes.stage;
  Real* to = Stage == 3 ? lanes.state : lanes.nextStage;
  const Row weight = Spread<Row>(Stage == 0 || Stage == 3 ? step / 6 : step / 3);
  const Row reach = Spread<Row>(Stage == 2 ? step : step / 2);
  const Real* given = lanes.acceleration;
  const Row acceleration = {given[0], given[1], given[2]};
  Row pressureShare = Spread<Row>(Real(0));
  if constexpr (Gas) pressureShare = Spread<Row>(FindPressureShare<Real>(tables, lanes, Real(6)));
  if (tables.isSolid) {
    ComputeElementForces(tables, from, lanes.stiffnessFactors[0], lanes.nextStage);
  } else {
    ComputePulls(tables, from, lanes.stiffnessFactors[0], lanes.nextStage);
  }
  Real errors[kErrorSums] = {};
  const std::uint32_t* ring = tables.ring;
  for (std::uint32_t i = 0; i < tables.count; ++i) {
    const SweepPlace<Real>& place = tables.places[i];
    Row force = LoadRow(lanes.nextStage + 6 * i);
    if constexpr (Gas) {
      const std::uint32_t* end = tables.ring + place.ringEnd;
      force = Fma(pressureShare, FindRingArea(ring, end, from, LoadRow(from + 6 * i)), force);
      ring = end;
    }
    if (lanes.outer != nullptr && lanes.hasOuter[i] != 0) {
      const Real* outer = lanes.outer + 3 * i;
      force = force + Row{outer[0], outer[1], outer[2]};
    }
    Row a = Fma(force, Spread<Row>(place.inverseMass), acceleration);
    if (tables.planar || place.inverseMass == Real(0)) {
      a = place.inverseMass == Real(0) ? Spread<Row>(Real(0)) : Row{a[0], Real(0), a[2]};
    }
    AdvanceRow<Stage>(lanes.state + 6 * i, lanes.increments + 6 * i, to + 6 * i, Rotate(LoadRow(from + 6 * i + 2)), a,
                      weight, reach, errors[i % kErrorSums]);
  }
  if constexpr (Gas) *lanes.sixVolume = FindSixVolume(tables, to);
  if constexpr (Stage == 0) *lanes.accelerationErrors = AddUp(errors);
  if constexpr (Stage == 3) *lanes.velocityErrors = AddUp(errors);
  if constexpr (Stage < 3) {
    ofBody.stage = lanes.nextStage;
    ofBody.nextStage = lanes.stage;
  }
}

template <int Stage, class Real>
void SweepStageAlone(const SweepTables<Real>& tables, SweepLanes<Real>& lanes, Real step) {
  if (tables.isRare && !tables.isSolid) {
    SweepOnce<Stage, true, true, true, Real>(tables, lanes, step);
  } else {
    tables.hasGas ? SweepAlone<Stage, true>(tables, lanes, step) : SweepAlone<Stage, false>(tables, lanes, step);
  }
}

template <class Real>
SweepKernel<Real> MakeLoneKernel() {
  return {.width = 1,
          .stages = {&SweepStageAlone<0, Real>, &SweepStageAlone<1, Real>, &SweepStageAlone<2, Real>,
                     &SweepStageAlone<3, Real>},
          .computeVolume = &ComputeSixVolume<Real, Real>,
          .computeContacts = &ComputePenaltyForces<Real, Real>,
          .bodyContacts = {.computeForces = &ComputeBodyContactForces<Real, Real>,
                           .update = &UpdateBodyContactBlock<Real, Real>},
          .gridStages = {&SweepGrid<0, Real, Real>, &SweepGrid<1, Real, Real>, &SweepGrid<2, Real, Real>,
                         &SweepGrid<3, Real, Real>},
          .points = {.findWithin = &FindPointsWithin<Real, Real>, .findNearest = &FindNearestPoint<Real, Real>},
          .planes = {.addForces = &AddPlaneForces<Real, Real>, .dragAnchors = &DragPlaneAnchors<Real, Real>}};
}

#undef WOBBLE_INLINE

}  // namespace
}  // namespace wobble::physics
