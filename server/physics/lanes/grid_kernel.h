// The sweep of grids, for the translation units that compile it for one instruction set each.
//
// Every spring's force is computed once, where it begins, and put down in a row of its own direction; the vertex that
// it ends at takes it from there when the sweep comes to its row. Adding it to that vertex at once, as the sweep of
// packs does, would write to lanes that the next direction reads one lane aside: each such read waits until the write
// is in the cache. Springs within a row are computed for the whole row first, for the same reason.
//
// A vertex adds up what comes from vertices before it, ascending, and then what it pulls with itself: an order that no
// width changes. Sums of squares over the body are kept for each column modulo the widest vector.
#pragma once

#include "server/physics/lanes/grid.h"
#include "server/physics/lanes/sweep.h"
#include "server/physics/lanes/terms.h"

namespace wobble::physics {
namespace {

#define WOBBLE_INLINE static inline __attribute__((always_inline))

inline constexpr std::uint32_t kGridSums = 16;

template <class V, class Real>
WOBBLE_INLINE V Load(const Real* from) {
  return *reinterpret_cast<const V*>(from);
}
template <class V, class Real>
WOBBLE_INLINE V LoadUnaligned(const Real* from) {
  V lanes;
  __builtin_memcpy(&lanes, from, sizeof(V));
  return lanes;
}
template <class V, class Real>
WOBBLE_INLINE void Store(V lanes, Real* to) {
  *reinterpret_cast<V*>(to) = lanes;
}

// Springs of one direction that begin in a row, at its column 0.
template <class Real>
struct GridSprings {
  const Real* coefficients;
  const Real* other;
  Real* forces;
};

// What is the same for all vertices of a row; forces are at its column 0.
template <class Real>
struct GridRow {
  const Real* own = nullptr;  // of the stage: [6][width]
  std::uint32_t pulledCount = 0;
  const Real* pulled[kMaxGridDirections + 4];  // forces on the row from rows before it and from within
  std::uint32_t withinCount = 0;
  std::uint32_t springCount = 0;
  GridSprings<Real> springs[kMaxGridDirections];  // those that end in the row come first
};

template <class Real>
WOBBLE_INLINE Real* FindForces(const GridTables<Real>& tables, Real* pending, const GridDirection& direction,
                               std::uint32_t row) {
  const std::uint32_t forceWidth = tables.width + 2 * tables.margin;
  return pending + direction.begin + row % direction.ringRows * 3 * forceWidth + tables.margin;
}

template <class Real>
WOBBLE_INLINE const Real* FindOther(const GridTables<Real>& tables, const Real* own, const GridDirection& direction) {
  return own + 6 * direction.rows * tables.width + direction.columns;
}

// rowsOf: coefficients of what goes in this direction, of row i at i * stride.
template <class Real>
WOBBLE_INLINE void AddPulled(const GridTables<Real>& tables, Real* pending, const GridDirection& direction,
                             const std::uint32_t* rowsOf, std::uint32_t stride, std::uint32_t row,
                             GridRow<Real>& found) {
  if (row < direction.rows || rowsOf[(row - direction.rows) * stride] == kNoGridRow) return;
  found.pulled[found.pulledCount++] = FindForces(tables, pending, direction, row - direction.rows) - direction.columns;
}

template <bool Drag, class Real>
WOBBLE_INLINE GridRow<Real> FindGridRow(const GridTables<Real>& tables, const Real* from, Real* pending,
                                    std::uint32_t row) {
  GridRow<Real> found;
  found.own = from + 6 * row * tables.width;
  const std::uint32_t count = tables.directionCount;
  for (std::uint32_t i = count; i-- > 0;) {
    AddPulled(tables, pending, tables.directions[i], tables.springRows + i, count, row, found);
  }
  if constexpr (Drag) {
    for (const GridDirection* corner : {&tables.squares.c, &tables.squares.b, &tables.squares.d, &tables.squares.a}) {
      AddPulled(tables, pending, *corner, tables.squareRows, 1, row, found);
    }
  }
  for (std::uint32_t i = 0; i < count; ++i) {
    const GridDirection& direction = tables.directions[i];
    const std::uint32_t coefficients = tables.springRows[row * count + i];
    if (coefficients == kNoGridRow) continue;
    found.springs[found.springCount++] = {tables.numbers + coefficients, FindOther(tables, found.own, direction),
                                          FindForces(tables, pending, direction, row)};
    if (direction.rows == 0) found.withinCount = found.springCount;
  }
  return found;
}

template <class V, class Real>
WOBBLE_INLINE void LoadVertices(const GridTables<Real>& tables, const Real* from, V* numbers) {
  for (std::uint32_t k = 0; k < 6; ++k) numbers[k] = Load<V>(from + k * tables.width);
}

template <class V, class Real>
WOBBLE_INLINE void StoreForce(const GridTables<Real>& tables, const Vector3Of<V>& force, Real* to) {
  const std::uint32_t forceWidth = tables.width + 2 * tables.margin;
  Store(force.x, to);
  Store(force.y, to + forceWidth);
  Store(force.z, to + 2 * forceWidth);
}

// Puts the pull of these springs down for their other ends.
template <class V, class Real>
WOBBLE_INLINE Vector3Of<V> ComputePull(const GridTables<Real>& tables, const GridSprings<Real>& springs,
                                       std::uint32_t column, const V* own, V factor) {
  const std::uint32_t width = tables.width;
  const Real* other = springs.other + column;
  const Real* coefficients = springs.coefficients + column;
  V there[6];
  for (std::uint32_t k = 0; k < 6; ++k) there[k] = LoadUnaligned<V>(other + k * width);
  const Vector3Of<V> l{own[0] - there[0], own[1] - there[1], own[2] - there[2]};
  const V rate = Fma(l.z, own[5] - there[5], Fma(l.y, own[4] - there[4], l.x * (own[3] - there[3])));
  const Vector3Of<V> pull = FindPull<Real>(l, rate, Load<V>(coefficients), Load<V>(coefficients + width),
                                           Load<V>(coefficients + 2 * width), factor);
  StoreForce(tables, pull, springs.forces + column);
  return pull;
}

// On each corner of a triangle, AddDrag of forces.h. share: ½ρC/6.
template <class V, class Real>
WOBBLE_INLINE Vector3Of<V> FindDrag(const V* a, const V* b, const V* c, const V* wind, V share) {
  const V ux = b[0] - a[0];
  const V uy = b[1] - a[1];
  const V uz = b[2] - a[2];
  const V wx = c[0] - a[0];
  const V wy = c[1] - a[1];
  const V wz = c[2] - a[2];
  const V sx = Fma(uy, wz, -(uz * wy));
  const V sy = Fma(uz, wx, -(ux * wz));
  const V sz = Fma(ux, wy, -(uy * wx));
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
WOBBLE_INLINE Vector3Of<V> Add(const Vector3Of<V>& a, const Vector3Of<V>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}

// Forces of the squares that begin in a row, on each of their corners.
template <class V, class Real>
WOBBLE_INLINE void ComputeSquares(const GridTables<Real>& tables, const Real* from, Real* pending, const Real* blowing,
                                  std::uint32_t row) {
  if (tables.squareRows[row] == kNoGridRow) return;
  const GridSquares& squares = tables.squares;
  const std::uint32_t width = tables.width;
  const Real* numbers = tables.numbers + tables.squareRows[row];
  const Real* atA = from + 6 * row * width;
  const Real* atB = FindOther(tables, atA, squares.b);
  const Real* atC = FindOther(tables, atA, squares.c);
  const Real* atD = FindOther(tables, atA, squares.d);
  Real* onA = FindForces(tables, pending, squares.a, row);
  Real* onB = FindForces(tables, pending, squares.b, row);
  Real* onC = FindForces(tables, pending, squares.c, row);
  Real* onD = FindForces(tables, pending, squares.d, row);
  const V wind[3] = {Spread<V>(blowing[0]), Spread<V>(blowing[width]), Spread<V>(blowing[2 * width])};
  const V zero = Spread<V>(Real(0));
  for (std::uint32_t column = 0; column < tables.columns; column += sizeof(V) / sizeof(Real)) {
    const V cut = Load<V>(numbers + 2 * width + column);
    V a[6];
    V b[6];
    V c[6];
    V d[6];
    V middle[6];  // the third corner of the first triangle, and the first of the second
    V other[6];
    for (std::uint32_t k = 0; k < 6; ++k) {
      a[k] = Load<V>(atA + k * width + column);
      b[k] = LoadUnaligned<V>(atB + k * width + column);
      c[k] = LoadUnaligned<V>(atC + k * width + column);
      d[k] = LoadUnaligned<V>(atD + k * width + column);
      middle[k] = cut > zero ? d[k] : c[k];
      other[k] = cut > zero ? b[k] : a[k];
    }
    const Vector3Of<V> first = FindDrag<V, Real>(a, b, middle, wind, Load<V>(numbers + column));
    const Vector3Of<V> second = FindDrag<V, Real>(other, c, d, wind, Load<V>(numbers + width + column));
    const Vector3Of<V> firstIfCut{cut > zero ? first.x : zero, cut > zero ? first.y : zero,
                                  cut > zero ? first.z : zero};
    const Vector3Of<V> firstElse{cut > zero ? zero : first.x, cut > zero ? zero : first.y, cut > zero ? zero : first.z};
    const Vector3Of<V> secondIfCut{cut > zero ? second.x : zero, cut > zero ? second.y : zero,
                                   cut > zero ? second.z : zero};
    const Vector3Of<V> secondElse{cut > zero ? zero : second.x, cut > zero ? zero : second.y,
                                  cut > zero ? zero : second.z};
    StoreForce(tables, Add(first, secondElse), onA + column);
    StoreForce(tables, Add(first, secondIfCut), onB + column);
    StoreForce(tables, Add(second, firstElse), onC + column);
    StoreForce(tables, Add(second, firstIfCut), onD + column);
  }
}

// The force on the vertices of a row from this column on.
template <class V, class Real>
WOBBLE_INLINE Vector3Of<V> SumForces(const GridTables<Real>& tables, const GridRow<Real>& row, std::uint32_t column,
                                     const V* own, V factor) {
  const std::uint32_t forceWidth = tables.width + 2 * tables.margin;
  const V zero = Spread<V>(Real(0));
  Vector3Of<V> force{zero, zero, zero};
  for (std::uint32_t i = 0; i < row.pulledCount; ++i) {
    const Real* pulled = row.pulled[i] + column;
    force.x = force.x + LoadUnaligned<V>(pulled);
    force.y = force.y + LoadUnaligned<V>(pulled + forceWidth);
    force.z = force.z + LoadUnaligned<V>(pulled + 2 * forceWidth);
  }
  for (std::uint32_t i = 0; i < row.withinCount; ++i) {
    const Real* pull = row.springs[i].forces + column;
    force.x = force.x - Load<V>(pull);
    force.y = force.y - Load<V>(pull + forceWidth);
    force.z = force.z - Load<V>(pull + 2 * forceWidth);
  }
  for (std::uint32_t i = row.withinCount; i < row.springCount; ++i) {
    const Vector3Of<V> pull = ComputePull(tables, row.springs[i], column, own, factor);
    force.x = force.x - pull.x;
    force.y = force.y - pull.y;
    force.z = force.z - pull.z;
  }
  return force;
}

template <class V, class Real>
WOBBLE_INLINE void DivideByMasses(const GridTables<Real>& tables, const Real* acceleration, const Real* inverseMasses,
                                  Vector3Of<V>& force) {
  const V zero = Spread<V>(Real(0));
  const V inverseMass = Load<V>(inverseMasses);
  const V x = Fma(force.x, inverseMass, Spread<V>(acceleration[0]));
  const V y = Fma(force.y, inverseMass, Spread<V>(acceleration[tables.width]));
  const V z = Fma(force.z, inverseMass, Spread<V>(acceleration[2 * tables.width]));
  force.x = inverseMass > zero ? x : zero;
  force.y = inverseMass > zero ? y : zero;
  force.z = inverseMass > zero ? z : zero;
  if (tables.planar) force.y = zero;
}

// Always in the same pairs.
template <class Real>
WOBBLE_INLINE Real AddUp(Real* sums) {
  for (std::uint32_t half = kGridSums / 2; half > 0; half /= 2) {
    for (std::uint32_t i = 0; i < half; ++i) sums[i] += sums[i + half];
  }
  return sums[0];
}

template <int Stage, bool Drag, bool Outer, class V, class Real>
void SweepGridOnce(const GridTables<Real>& ofBlueprint, SweepLanes<Real>& ofBody, Real step) {
  constexpr std::uint32_t kWidth = sizeof(V) / sizeof(Real);
  const GridTables<Real> tables = ofBlueprint;
  const SweepLanes<Real> lanes = ofBody;
  const Real* from = Stage == 0 ? lanes.state : lanes.stage;
  Real* to = Stage == 3 ? lanes.state : lanes.nextStage;
  const V factor = Spread<V>(lanes.stiffnessFactors[0]);
  const V weight = Spread<V>(Stage == 0 || Stage == 3 ? step / 6 : step / 3);
  const V reach = Spread<V>(Stage == 2 ? step : step / 2);
  const std::uint32_t width = tables.width;
  alignas(64) Real errors[kGridSums] = {};
  for (std::uint32_t i = 0; i < tables.rows; ++i) {
    const GridRow<Real> row = FindGridRow<Drag>(tables, from, lanes.pending, i);
    for (std::uint32_t column = 0; row.withinCount > 0 && column < tables.columns; column += kWidth) {
      V own[6];
      LoadVertices(tables, row.own + column, own);
      for (std::uint32_t k = 0; k < row.withinCount; ++k) ComputePull(tables, row.springs[k], column, own, factor);
    }
    if constexpr (Drag) ComputeSquares<V>(tables, from, lanes.pending, lanes.wind, i);
    const bool hasOuter = Outer && lanes.hasOuter[i] != 0;
    for (std::uint32_t column = 0; column < tables.columns; column += kWidth) {
      V own[6];
      LoadVertices(tables, row.own + column, own);
      Vector3Of<V> force = SumForces<V>(tables, row, column, own, factor);
      if (hasOuter) {
        const Real* outer = lanes.outer + 3 * i * width + column;
        force.x = force.x + Load<V>(outer);
        force.y = force.y + Load<V>(outer + width);
        force.z = force.z + Load<V>(outer + 2 * width);
      }
      DivideByMasses(tables, lanes.acceleration, tables.inverseMasses + i * width + column, force);
      const std::uint32_t vertex = 6 * i * width + column;
      const auto vectorsAt = [vertex](Real* array) { return reinterpret_cast<V*>(array + vertex); };
      V& sums = *reinterpret_cast<V*>(errors + column % kGridSums);
      Advance<Stage>(vectorsAt(lanes.state), vectorsAt(lanes.increments), vectorsAt(to), width / kWidth, own, force,
                     weight, reach, sums);
    }
  }
  if constexpr (Stage == 0) *lanes.accelerationErrors = AddUp(errors);
  if constexpr (Stage == 3) *lanes.velocityErrors = AddUp(errors);
  if constexpr (Stage < 3) {
    ofBody.stage = lanes.nextStage;
    ofBody.nextStage = lanes.stage;
  }
}

template <int Stage, class V, class Real>
void SweepGrid(const GridTables<Real>& tables, SweepLanes<Real>& lanes, Real step) {
  if (lanes.outer != nullptr) {
    tables.hasDrag ? SweepGridOnce<Stage, true, true, V>(tables, lanes, step)
                   : SweepGridOnce<Stage, false, true, V>(tables, lanes, step);
  } else {
    tables.hasDrag ? SweepGridOnce<Stage, true, false, V>(tables, lanes, step)
                   : SweepGridOnce<Stage, false, false, V>(tables, lanes, step);
  }
}

#undef WOBBLE_INLINE

}  // namespace
}  // namespace wobble::physics
