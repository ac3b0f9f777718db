// The elements of a lone solid, one in each lane: four or eight are computed at a time and their forces added one by
// one, in the order of the sweep of packs, so that every sum has the same bits (see lone_kernel.h).
#pragma once

#include "server/physics/kernels/solid_terms.h"
#include "server/physics/kernels/sweep.h"
#include "server/physics/lanes/lanes.h"
#include "server/physics/lanes/vertex_rows.h"

namespace wobble::physics {
namespace {

#define WOBBLE_INLINE static inline __attribute__((always_inline))

// The numbers of the elements from `begin` on.
template <class V, class Real>
struct ColumnConstants {
  const Real* begin;
  std::uint32_t padded;

  V Read(std::uint32_t column) const {
    V lanes;
    __builtin_memcpy(&lanes, begin + column * padded, sizeof(V));
    return lanes;
  }
  V Gradient(int i, int c) const { return Read(static_cast<std::uint32_t>(3 * i + c)); }
  V Shear() const { return Read(9); }
  V Bulk() const { return Read(10); }
  V Viscosity() const { return Read(11); }
};

// The differences near − far of four numbers from `from` on, for the pairs of places that `ends` begins with: one
// vector a number, one lane a pair.
template <class Real, class V>
WOBBLE_INLINE void LoadDifferences(const Real* from, const std::uint32_t* ends, V (&rows)[4]) {
  for (int i = 0; i < 4; ++i) {
    const std::uint32_t* near = ends + 2 * i;
    const std::uint32_t* far = sizeof(V) / sizeof(Real) > 4 ? near + 8 : near;
    rows[i] = LoadRows(from + near[0], from + far[0]) - LoadRows(from + near[1], from + far[1]);
  }
  Transpose(rows);
}

// The pulls of as many elements as V has lanes, from `begin` on, as rows.
template <class Real, class V>
WOBBLE_INLINE void FindElementRows(const SweepTables<Real>& tables, std::uint32_t begin, const Real* from, V factor,
                                   V (&rows)[3][4]) {
  const ElementColumns<Real>& columns = tables.elementColumns;
  const ColumnConstants<V, Real> constants{columns.numbers + begin, columns.padded};
  V ways[3][3];
  V speeds[3][3];
  for (std::uint32_t i = 0; i < 3; ++i) {
    const std::uint32_t* ends = columns.ends + 2 * (i * columns.padded + begin);
    V l[4];
    V u[4];  // z, then the velocity: so nothing is read beyond the last vertex
    LoadDifferences(from, ends, l);
    LoadDifferences(from + 2, ends, u);
    for (int k = 0; k < 3; ++k) {
      ways[i][k] = l[k];
      speeds[i][k] = u[k + 1];
    }
  }
  V f[3][3];
  V stress[3][3];
  FindGradient(constants, ways, f);
  FindElasticStress(constants, tables.restRatio, factor, f, stress);
  if (tables.elements->viscosity > Real(0)) {
    V rates[3][3];
    FindGradient(constants, speeds, rates);
    AddViscousStress(constants, factor, f, rates, stress);
  }
  V pulls[3][3];
  FindElementPulls(constants, stress, pulls);
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) rows[i][k] = pulls[i][k];
    rows[i][3] = Spread<V>(Real(0));
    Transpose(rows[i]);
  }
}

// Sets the elements' forces on all vertices. forces: six numbers a place, of which the first four are written.
template <class Real>
__attribute__((noinline)) void ComputeElementForces(const SweepTables<Real>& tables, const Real* from,
                                                    Real stiffnessFactor, Real* forces) {
  using V = typename RowsOf<Real>::Lanes;
  using Row = typename RowsOf<Real>::Row;
  constexpr std::uint32_t kWidth = sizeof(V) / sizeof(Real);
  const ElementColumns<Real> columns = tables.elementColumns;
  const V factor = Spread<V>(stiffnessFactor);
  for (std::uint32_t i = 0; i < tables.count; ++i) StoreRow(Spread<Row>(Real(0)), forces + 6 * i);
  for (std::uint32_t begin = 0; begin < columns.count; begin += kWidth) {
    V rows[3][4];
    FindElementRows(tables, begin, from, factor, rows);
    const std::uint32_t left = columns.count - begin;
    for (std::uint32_t lane = 0; lane < (left < kWidth ? left : kWidth); ++lane) {
      const std::uint32_t* ends = columns.ends + 2 * (begin + lane);
      Real* const onFirst = forces + ends[1];
      Row sum = LoadRow(onFirst);
      for (std::uint32_t i = 0; i < 3; ++i) {
        const Row pull = FindRow(rows[i][lane % 4], lane >= 4);
        Real* const onOther = forces + ends[2 * i * columns.padded];
        sum = sum + pull;
        StoreRow(LoadRow(onOther) - pull, onOther);
      }
      StoreRow(sum, onFirst);
    }
  }
}

// √3 times Frobenius' norm of Cᵀ C, as in methods/elasticity.cpp.
template <class Real, class V>
WOBBLE_INLINE V BoundSquare(const V (&c)[3][3]) {
  V squares = Spread<V>(Real(0));
  V products = squares;
  for (int i = 0; i < 3; ++i) {
    const V along = FindDot(c[i], c[i]);
    const V across = FindDot(c[i], c[(i + 1) % 3]);
    squares = Fma(along, along, squares);
    products = Fma(across, across, products);
  }
  return Sqrt(Spread<V>(Real(3)) * Fma(Spread<V>(Real(2)), products, squares));
}

// Of as many elements as V has lanes, from `begin` on. positions: x y z of each vertex.
template <class Real, class V>
WOBBLE_INLINE void AddStrains(const SweepTables<Real>& tables, std::uint32_t begin, const Real* positions, V& longest,
                              V& stiffest) {
  const ElementColumns<Real>& columns = tables.elementColumns;
  const ColumnConstants<V, Real> constants{columns.numbers + begin, columns.padded};
  V ways[3][3];
  for (std::uint32_t i = 0; i < 3; ++i) {
    const std::uint32_t* ends = columns.vertices + 2 * (i * columns.padded + begin);
    V rows[4];
    for (std::uint32_t k = 0; k < 4; ++k) {
      const std::uint32_t* near = ends + 2 * k;
      const std::uint32_t* far = sizeof(V) / sizeof(Real) > 4 ? near + 8 : near;
      rows[k] =
          LoadThrees(positions + near[0], positions + far[0]) - LoadThrees(positions + near[1], positions + far[1]);
    }
    Transpose(rows);
    for (int k = 0; k < 3; ++k) ways[i][k] = rows[k];
  }
  V f[3][3];
  V cofactors[3][3];
  FindGradient(constants, ways, f);
  for (int c = 0; c < 3; ++c) FindCross(f[(c + 1) % 3], f[(c + 2) % 3], cofactors[c]);
  const V square = FindDot(f[0], f[0]) + FindDot(f[1], f[1]) + FindDot(f[2], f[2]);
  const V beyond = FindDot(f[0], cofactors[0]) - Spread<V>(tables.restRatio);
  const V ofVolume = Max(beyond, -beyond) * Sqrt(square / Spread<V>(Real(3)));
  const V bound = Fma(Spread<V>(Real(2)), ofVolume, BoundSquare<Real>(cofactors));
  const V ofStretch = BoundSquare<Real>(f);
  const V spread = Spread<V>(Real(2)) * (ofStretch * ofStretch - square * square);
  longest = Max((square + Sqrt(Max(spread, Spread<V>(Real(0))))) / Spread<V>(Real(3)), longest);
  stiffest = Max(Fma(Spread<V>(tables.elements->bulk / tables.elements->shear), bound, Spread<V>(Real(1))), stiffest);
}

template <class Real>
ElementStrain<Real> FindStrain(const SweepTables<Real>& tables, const Real* positions) {
  using V = typename RowsOf<Real>::Lanes;
  constexpr std::uint32_t kWidth = sizeof(V) / sizeof(Real);
  V longest = Spread<V>(Real(0));
  V stiffest = longest;
  for (std::uint32_t begin = 0; begin < tables.elementColumns.count; begin += kWidth) {
    AddStrains(tables, begin, positions, longest, stiffest);
  }
  ElementStrain<Real> strain;
  for (std::uint32_t lane = 0; lane < kWidth; ++lane) {
    strain.squareStretch = Max(Real(longest[lane]), strain.squareStretch);
    strain.stiffness = Max(Real(stiffest[lane]), strain.stiffness);
  }
  return strain;
}

#undef WOBBLE_INLINE

}  // namespace
}  // namespace wobble::physics
