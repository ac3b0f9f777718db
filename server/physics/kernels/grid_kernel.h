// The sweep of grids (grid.h). Compiled once for each instruction set.
//
// Every spring's force is computed once, at the vertex where the spring begins, and stored in a row of its direction;
// the vertex at the other end reads it from there when the sweep comes to its row. Rejected: adding it to that vertex
// at once, as the sweep of packs does. That writes to lanes that the next direction reads one lane aside, and each such
// read waits until the write is in the cache. For the same reason, springs within a row are computed for the whole row
// first.
//
// A vertex adds the forces from earlier vertices, ascending, and then those of its own springs. The order does not
// depend on the width, and it is the order of a body in a lane of a pack.
#pragma once

#include "server/physics/kernels/grid.h"
#include "server/physics/kernels/rare_terms.h"
#include "server/physics/kernels/sweep.h"
#include "server/physics/kernels/terms.h"

namespace wobble::physics {
namespace {

#define WOBBLE_INLINE static inline __attribute__((always_inline))

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

// The springs of one direction that begin in a row; pointers to the row's column 0.
template <class Real>
struct GridSprings {
  const Real* coefficients;
  const Real* other;
  Real* forces;
};

// The pointers that all vertices of a row share; to the row's column 0.
template <class Real>
struct GridRow {
  const Real* own = nullptr;  // of the stage: [6][width]
  std::uint32_t pulledCount = 0;
  const Real* pulled[kMaxGridDirections + 4];  // forces on the row, from earlier rows and from within it
  std::uint32_t bentCount = 0;
  const Real* bent[4 * kMaxGridHinges];  // pulls of hinges on the row
  Real bentWeights[4 * kMaxGridHinges];  // what a vertex gets of them
  std::uint32_t withinCount = 0;
  std::uint32_t springCount = 0;
  GridSprings<Real> springs[kMaxGridDirections];  // the first withinCount end in the same row
};

template <class Real, class Forces>
WOBBLE_INLINE Forces* FindForces(const GridTables<Real>& tables, Forces* pending, const GridDirection& direction,
                                 std::uint32_t row) {
  const std::uint32_t forceWidth = tables.width + 2 * tables.margin;
  return pending + direction.begin + row % direction.ringRows * 3 * forceWidth + tables.margin;
}

template <class Real>
WOBBLE_INLINE const Real* FindOther(const GridTables<Real>& tables, const Real* own, const GridDirection& direction) {
  return own + 6 * direction.rows * tables.width + direction.columns;
}

// Adds the stored forces of one direction on a row to found.pulled, if there are any. rowsOf: GridTables::springRows or
// squareRows of that direction, row i at i * stride.
template <class Real>
WOBBLE_INLINE void AddPulled(const GridTables<Real>& tables, Real* pending, const GridDirection& direction,
                             const std::uint32_t* rowsOf, std::uint32_t stride, std::uint32_t row,
                             GridRow<Real>& found) {
  if (row < direction.rows || rowsOf[(row - direction.rows) * stride] == kNoGridRow) return;
  found.pulled[found.pulledCount++] = FindForces(tables, pending, direction, row - direction.rows) - direction.columns;
}

// Adds the pulls of one kind of hinge on a row's vertices, in the place of a, b, c and d, to found.bent. Never inlined:
// few bodies have hinges.
template <class Real>
__attribute__((noinline)) void AddBent(const GridTables<Real>& tables, const Real* pending, std::uint32_t kind,
                                       std::uint32_t row, GridRow<Real>& found) {
  const GridHinges& hinges = tables.hinges[kind];
  const auto add = [&](const GridDirection& way, Real weight) {
    if (row < way.rows || tables.hingeRows[(row - way.rows) * tables.hingeCount + kind] == kNoGridRow) return;
    found.bent[found.bentCount] = FindForces(tables, pending, hinges.d, row - way.rows) - way.columns;
    found.bentWeights[found.bentCount++] = weight;
  };
  const bool isStraight = hinges.b.rows == hinges.c.rows && hinges.b.columns == hinges.c.columns;
  add({}, Real(-1));
  add(hinges.b, Real(isStraight ? 2 : 1));
  if (!isStraight) add(hinges.c, Real(1));
  add(hinges.d, Real(-1));
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
  for (std::uint32_t kind = 0; kind < tables.hingeCount; ++kind) AddBent(tables, pending, kind, row, found);
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

// Computes the pulls of these springs and stores them for their other ends.
template <class V, class Real>
WOBBLE_INLINE Vector3Of<V> ComputePull(const GridTables<Real>& tables, const GridSprings<Real>& springs,
                                       std::uint32_t column, const V* own, V factor) {
  const std::uint32_t width = tables.width;
  const Real* other = springs.other + column;
  const Real* coefficients = springs.coefficients + column;
  V there[6];
  for (std::uint32_t k = 0; k < 6; ++k) there[k] = LoadUnaligned<V>(other + k * width);
  const Vector3Of<V> pull = FindPull<Real>(FindEnds(own, there), Load<V>(coefficients), Load<V>(coefficients + width),
                                           Load<V>(coefficients + 2 * width), factor);
  StoreForce(tables, pull, springs.forces + column);
  return pull;
}

template <class V, class Real>
WOBBLE_INLINE void ComputePullsWithin(const GridTables<Real>& tables, const GridRow<Real>& row, V factor) {
  if (row.withinCount == 0) return;
  for (std::uint32_t column = 0; column < tables.columns; column += sizeof(V) / sizeof(Real)) {
    V own[6];
    LoadVertices(tables, row.own + column, own);
    for (std::uint32_t i = 0; i < row.withinCount; ++i) ComputePull(tables, row.springs[i], column, own, factor);
  }
}

template <class V>
WOBBLE_INLINE V Choose(V cut, V ifCut, V otherwise) {
  return cut > V{} ? ifCut : otherwise;
}

// a + b where the square is cut from b to d, else a + c.
template <class V>
WOBBLE_INLINE Vector3Of<V> AddChosen(V cut, const Vector3Of<V>& a, const Vector3Of<V>& b, const Vector3Of<V>& c) {
  return {a.x + Choose(cut, b.x, c.x), a.y + Choose(cut, b.y, c.y), a.z + Choose(cut, b.z, c.z)};
}

// Computes the drag of the squares that begin in a row and stores it for each of their corners.
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
  for (std::uint32_t column = 0; column < tables.columns; column += sizeof(V) / sizeof(Real)) {
    const V cut = Load<V>(numbers + 2 * width + column);
    V a[6], b[6], c[6], d[6];
    V middle[6];  // the third corner of the first triangle
    V other[6];   // the first of the second
    for (std::uint32_t k = 0; k < 6; ++k) {
      a[k] = Load<V>(atA + k * width + column);
      b[k] = LoadUnaligned<V>(atB + k * width + column);
      c[k] = LoadUnaligned<V>(atC + k * width + column);
      d[k] = LoadUnaligned<V>(atD + k * width + column);
      middle[k] = Choose(cut, d[k], c[k]);
      other[k] = Choose(cut, b[k], a[k]);
    }
    const Vector3Of<V> none{V{}, V{}, V{}};
    const Vector3Of<V> first = FindDrag<Real, V>(a, b, middle, wind, Load<V>(numbers + column));
    const Vector3Of<V> second = FindDrag<Real, V>(other, c, d, wind, Load<V>(numbers + width + column));
    StoreForce(tables, AddChosen(cut, first, none, second), onA + column);
    StoreForce(tables, AddChosen(cut, first, second, none), onB + column);
    StoreForce(tables, AddChosen(cut, second, none, first), onC + column);
    StoreForce(tables, AddChosen(cut, second, first, none), onD + column);
  }
}

// Computes the pulls of the hinges whose a is in a row.
template <class V, class Real>
__attribute__((noinline)) void ComputeHinges(const GridTables<Real>& tables, const Real* from, Real* pending, V factor,
                                             std::uint32_t row) {
  const std::uint32_t width = tables.width;
  const V floorSquare = Spread<V>(tables.hingeFloorSquare);
  for (std::uint32_t kind = 0; kind < tables.hingeCount; ++kind) {
    const std::uint32_t coefficients = tables.hingeRows[row * tables.hingeCount + kind];
    if (coefficients == kNoGridRow) continue;
    const GridHinges& hinges = tables.hinges[kind];
    const Real* numbers = tables.numbers + coefficients;
    const Real* atA = from + 6 * row * width;
    const Real* atB = FindOther(tables, atA, hinges.b);
    const Real* atC = FindOther(tables, atA, hinges.c);
    const Real* atD = FindOther(tables, atA, hinges.d);
    Real* pulls = FindForces(tables, pending, hinges.d, row);
    for (std::uint32_t column = 0; column < tables.columns; column += sizeof(V) / sizeof(Real)) {
      V a[6], b[6], c[6], d[6];
      for (std::uint32_t k = 0; k < 6; ++k) {
        a[k] = Load<V>(atA + k * width + column);
        b[k] = LoadUnaligned<V>(atB + k * width + column);
        c[k] = LoadUnaligned<V>(atC + k * width + column);
        d[k] = LoadUnaligned<V>(atD + k * width + column);
      }
      const Vector3Of<V> pull = FindHingePull<Real, V>(a, b, c, d, Load<V>(numbers + column),
                                                       Load<V>(numbers + width + column), floorSquare, factor);
      StoreForce(tables, pull, pulls + column);
    }
  }
}

// The force on a vector of vertices, from this column of a row on.
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
  for (std::uint32_t i = 0; i < row.bentCount; ++i) {
    const Real* bent = row.bent[i] + column;
    const V weight = Spread<V>(row.bentWeights[i]);
    force.x = Fma(weight, LoadUnaligned<V>(bent), force.x);
    force.y = Fma(weight, LoadUnaligned<V>(bent + forceWidth), force.y);
    force.z = Fma(weight, LoadUnaligned<V>(bent + 2 * forceWidth), force.z);
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
WOBBLE_INLINE void AddOuter(const Real* outer, std::uint32_t width, Vector3Of<V>& force) {
  force.x = force.x + Load<V>(outer);
  force.y = force.y + Load<V>(outer + width);
  force.z = force.z + Load<V>(outer + 2 * width);
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

// Turns sums by vertex number into sums by column of a row whose first vertex has the number `by`; with kErrorSums −
// by, the other way.
template <class Real>
WOBBLE_INLINE void RotateSums(const Real* sums, std::uint32_t by, Real* rotated) {
  for (std::uint32_t i = 0; i < kErrorSums; ++i) rotated[i] = sums[(i + by) % kErrorSums];
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
  Real errors[kErrorSums] = {};
  alignas(64) Real errorsOfRow[kErrorSums];
  for (std::uint32_t i = 0; i < tables.rows; ++i) {
    const GridRow<Real> row = FindGridRow<Drag>(tables, from, lanes.pending, i);
    ComputePullsWithin(tables, row, factor);
    if constexpr (Drag) ComputeSquares<V>(tables, from, lanes.pending, lanes.wind, i);
    if (tables.hingeCount > 0) ComputeHinges<V>(tables, from, lanes.pending, factor, i);
    const std::uint32_t firstSum = i * tables.columns % kErrorSums;
    if constexpr (Stage == 0 || Stage == 3) RotateSums(errors, firstSum, errorsOfRow);
    const bool hasOuter = Outer && lanes.hasOuter[i] != 0;
    for (std::uint32_t column = 0; column < tables.columns; column += kWidth) {
      V own[6];
      LoadVertices(tables, row.own + column, own);
      Vector3Of<V> force = SumForces<V>(tables, row, column, own, factor);
      if (hasOuter) AddOuter(lanes.outer + 3 * i * width + column, width, force);
      DivideByMasses(tables, lanes.acceleration, tables.inverseMasses + i * width + column, force);
      const std::uint32_t vertex = 6 * i * width + column;
      const auto vectorsAt = [vertex](Real* array) { return reinterpret_cast<V*>(array + vertex); };
      V& sums = *reinterpret_cast<V*>(errorsOfRow + column % kErrorSums);
      Advance<Stage>(vectorsAt(lanes.state), vectorsAt(lanes.increments), vectorsAt(to), width / kWidth, own, force,
                     weight, reach, sums);
    }
    if constexpr (Stage == 0 || Stage == 3) RotateSums(errorsOfRow, kErrorSums - firstSum, errors);
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
