// The tables that the row-by-row sweep of a grid reads (kernels/grid.h), computed once per blueprint.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/physics/kernels/grid.h"

namespace wobble::physics {

template <class Real>
struct Coefficients;

// The shape of a grid of vertices. Their numbers run along columns first, then rows, then layers.
struct GridShape {
  std::uint32_t columns = 0;  // in vertices, as the others; 0: no grid
  std::uint32_t rows = 0;
  std::uint32_t layers = 1;

  [[nodiscard]] std::size_t CountVertices() const { return std::size_t{columns} * rows * layers; }
};

// One cache line of numbers, which is as long as the longest vector.
template <class Real>
struct alignas(64) GridLine {
  static constexpr std::size_t kNumbers = 64 / sizeof(Real);
  std::array<Real, kNumbers> numbers{};
};

// Rows of coefficients and where each stands; see GridTables.
template <class Real>
struct GridRows {
  std::vector<GridLine<Real>> numbers;
  std::vector<std::uint32_t> springRows;
  std::vector<std::uint32_t> squareRows;
  std::vector<std::uint32_t> hingeRows;
};

template <class Real>
struct GridPlan {
  std::uint32_t rows = 0;  // rows of the sweep, which may hold several rows of the grid; 0: the body cannot be swept so
  std::uint32_t columns = 0;
  std::uint32_t width = 0;
  std::uint32_t margin = 0;
  std::uint32_t pendingSize = 0;  // length of SweepLanes::pending, which is all zero before the first sweep
  std::vector<GridLine<Real>> inverseMasses;
  std::vector<GridDirection> directions;
  GridSquares squares;
  std::vector<GridHinges> hinges;
  Real hingeFloorSquare = 0;
  GridRows<Real> coefficients;
  bool planar = false;
  bool hasDrag = false;

  [[nodiscard]] std::uint32_t RowOf(std::size_t vertex) const { return static_cast<std::uint32_t>(vertex) / columns; }
  [[nodiscard]] std::uint32_t ColumnOf(std::size_t vertex) const {
    return static_cast<std::uint32_t>(vertex) % columns;
  }
  // The number of rows in the arrays of a body. One more than the sweep has, because it also reads the far ends of
  // springs that do not exist, beyond the last vertex. Places without a vertex must hold finite numbers.
  [[nodiscard]] std::uint32_t CountPlaces() const { return rows + 1; }

  // The tables with the plan's own coefficients or with those of a torn body (RemoveTorn). Valid while both live.
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
            .hingeCount = static_cast<std::uint32_t>(hinges.size()),
            .hinges = hinges.data(),
            .hingeRows = ofBody.hingeRows.data(),
            .hingeFloorSquare = hingeFloorSquare,
            .planar = planar,
            .hasDrag = hasDrag};
  }
};

// Makes the plan of a body that has springs and, if it is a sheet, drag on its squares. The plan is empty if the body
// is no grid, has gas or repulsion, has springs in more than kMaxGridDirections directions or two springs of a vertex
// in one direction, the same of hinges and kMaxGridHinges, or has drag on faces that are not halves of squares.
template <class Real>
[[nodiscard]] GridPlan<Real> MakeGridPlan(const Coefficients<Real>& body, const GridShape& shape);

// Fills `rows` with the plan's coefficients, those of torn springs set to zero. torn: one a spring of the body, not 0
// if it has torn; may be empty.
template <class Real>
void RemoveTorn(const GridPlan<Real>& plan, const Coefficients<Real>& body, std::span<const std::uint8_t> torn,
                GridRows<Real>& rows);

}  // namespace wobble::physics
