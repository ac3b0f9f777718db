// What the sweep of a grid needs, worked out once per blueprint.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/physics/lanes/grid.h"

namespace wobble::physics {

template <class Real>
struct Coefficients;

// How the vertices of a body are numbered that stand in a grid: along columns first, then rows, then layers.
struct GridShape {
  std::uint32_t columns = 0;  // of vertices, likewise for the others; 0: no grid
  std::uint32_t rows = 0;
  std::uint32_t layers = 1;

  [[nodiscard]] std::size_t CountVertices() const { return std::size_t{columns} * rows * layers; }
};

// Numbers by the line of the cache, which is as long as the longest vector.
template <class Real>
struct alignas(64) GridLine {
  static constexpr std::size_t kNumbers = 64 / sizeof(Real);
  std::array<Real, kNumbers> numbers{};
};

// Where rows of coefficients stand, and the rows; see GridTables.
template <class Real>
struct GridRows {
  std::vector<GridLine<Real>> numbers;
  std::vector<std::uint32_t> springRows;
  std::vector<std::uint32_t> squareRows;
};

template <class Real>
struct GridPlan {
  std::uint32_t rows = 0;  // of the sweep; 0: the body cannot be swept so
  std::uint32_t columns = 0;
  std::uint32_t width = 0;
  std::uint32_t margin = 0;
  std::uint32_t pendingSize = 0;  // of SweepLanes::pending, numbers; all 0 before the first sweep
  std::vector<GridLine<Real>> inverseMasses;
  std::vector<GridDirection> directions;
  GridSquares squares;
  GridRows<Real> coefficients;
  bool planar = false;
  bool hasDrag = false;

  [[nodiscard]] std::uint32_t RowOf(std::size_t vertex) const { return static_cast<std::uint32_t>(vertex) / columns; }
  [[nodiscard]] std::uint32_t ColumnOf(std::size_t vertex) const {
    return static_cast<std::uint32_t>(vertex) % columns;
  }
  // Rows that arrays of a body are to have: springs that are not there are looked for beyond the last vertex. Whatever
  // is no vertex must hold finite numbers.
  [[nodiscard]] std::uint32_t CountPlaces() const { return rows + 1; }

  // With the plan's own coefficients or those of a body that has torn.
  [[nodiscard]] GridTables<Real> Tables(const GridRows<Real>& ofBody) const {
    return {.rows = rows,
            .columns = columns,
            .width = width,
            .margin = margin,
            .inverseMasses = reinterpret_cast<const Real*>(inverseMasses.data()),
            .numbers = reinterpret_cast<const Real*>(ofBody.numbers.data()),
            .directionCount = static_cast<std::uint32_t>(directions.size()),
            .directions = directions.data(),
            .springRows = ofBody.springRows.data(),
            .squareRows = ofBody.squareRows.data(),
            .squares = squares,
            .planar = planar,
            .hasDrag = hasDrag};
  }
};

// Of a body of springs, with drag on its squares if it is a sheet, and with nothing else. Empty where it has gas or
// repulsion, where springs leave its vertices in too many directions, or two of a vertex in one, or where faces are not
// halves of squares.
template <class Real>
[[nodiscard]] GridPlan<Real> MakeGridPlan(const Coefficients<Real>& body, const GridShape& shape);

// The plan's coefficients without those of torn springs. torn: one a spring of the body, not 0 where it has torn.
template <class Real>
void RemoveTorn(const GridPlan<Real>& plan, const Coefficients<Real>& body, std::span<const std::uint8_t> torn,
                GridRows<Real>& rows);

}  // namespace wobble::physics
