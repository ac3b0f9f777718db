// The tables for sweeping a body whose vertices stand in a grid (cloths, lattices) row by row: lane l of a row is the
// vertex in column l. So a lone body fills whole vectors, and a neighbour is equally far away for all vertices of a
// row.
//
// A row is a place of sweep.h and its columns are the lanes: arrays are [row][k][column], with rows padded to `width`
// columns, a multiple of a cache line. So code that fills a pack of bodies, or adds forces to it, fills a grid alike.
#pragma once

#include <cstdint>

namespace wobble::physics {

// The most directions in which springs leave the vertices of a body.
inline constexpr std::uint32_t kMaxGridDirections = 16;
// Stands for a row of coefficients that are all zero.
inline constexpr std::uint32_t kNoGridRow = 0xFFFFFFFF;

// A direction: springs or corners of squares act between each vertex of a row and the vertex `rows` rows and `columns`
// columns further on. Their forces on the latter stand in SweepLanes::pending from `begin` on as
// [ringRows][3][forceWidth], those of a row at its number modulo ringRows.
struct GridDirection {
  std::uint32_t rows = 0;
  std::int32_t columns = 0;  // of either sign; above 0 if `rows` is 0
  std::uint32_t ringRows = 1;
  std::uint32_t begin = 0;
};

// The squares of a sheet: corner a, b below a, d beside a, c opposite. A square is two triangles: a b c and a c d, or
// if it is cut the other way a b d and b c d. The forces on each corner have a direction of their own.
struct GridSquares {
  GridDirection a;
  GridDirection b;
  GridDirection c;
  GridDirection d;
};

// Hinges of one kind (model/hinge.h), at most one at each vertex a: where b, c and d are from there. b and c may be
// one. The pulls of the hinges stand where `d` says; b and c have no forces of their own.
struct GridHinges {
  GridDirection b;
  GridDirection c;
  GridDirection d;
};
inline constexpr std::uint32_t kMaxGridHinges = 3;  // kinds

// A GridPlan as bare arrays, for the reason given at SweepTables. Rows of coefficients stand in `numbers` as [3][width]
// each, of hinges as [2][width]; equal rows stand there once.
template <class Real>
struct GridTables {
  std::uint32_t rows = 0;
  std::uint32_t columns = 0;
  std::uint32_t width = 0;
  std::uint32_t margin = 0;             // zeros on either side of a row of forces: forceWidth is width + 2 margin
  const Real* inverseMasses = nullptr;  // [row][width], 1/kg; 0: fixed, or no vertex
  const Real* numbers = nullptr;
  std::uint32_t directionCount = 0;
  const GridDirection* directions = nullptr;  // of springs, ascending by what they add to a vertex's number
  // [row][direction]: where k, k r and c of the springs that begin in the row stand in `numbers`, or kNoGridRow.
  const std::uint32_t* springRows = nullptr;
  // [row]: where ½ρC/6 of the first and of the second triangle, and the cut (above 0: from b to d), stand in `numbers`.
  const std::uint32_t* squareRows = nullptr;
  GridSquares squares;
  std::uint32_t hingeCount = 0;  // of kinds
  const GridHinges* hinges = nullptr;
  // [row][kind]: where k and c of the hinges whose a is in the row stand in `numbers`, or kNoGridRow.
  const std::uint32_t* hingeRows = nullptr;
  Real hingeFloorSquare = 0;  // m²
  bool planar = false;
  bool hasDrag = false;
};

}  // namespace wobble::physics
