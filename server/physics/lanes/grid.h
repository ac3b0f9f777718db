// Bodies whose vertices stand in a grid (cloths, lattices), swept row by row: lane l of a row is the vertex in column
// l, so a lone body fills whole vectors, and what a vertex is joined to lies as far away for all of a row.
//
// A row is a place of sweep.h and its columns are the lanes: arrays are [row][k][column], with rows padded to `width`
// columns, a whole line of the cache. So whoever fills a pack of bodies, or adds forces to it, fills a grid alike.
#pragma once

#include <cstdint>

namespace wobble::physics {

// Springs of a body leave its vertices in so many directions at most.
inline constexpr std::uint32_t kMaxGridDirections = 16;
// Where no spring or square begins in a row.
inline constexpr std::uint32_t kNoGridRow = 0xFFFFFFFF;

// Something that acts between each vertex of a row and the one so many rows and columns further on, and where its
// forces on the latter stand in SweepLanes::pending: [ringRows][3][forceWidth], a row's at its number modulo ringRows.
struct GridDirection {
  std::uint32_t rows = 0;
  std::int32_t columns = 0;  // either way; above 0 where `rows` is 0
  std::uint32_t ringRows = 1;
  std::uint32_t begin = 0;
};

// The squares of a sheet: corners a, b below it, d beside it and c across. Two triangles, a b c and a c d or, where it
// is cut the other way, a b d and b c d. Their forces on each corner go by a way of its own.
struct GridSquares {
  GridDirection a;
  GridDirection b;
  GridDirection c;
  GridDirection d;
};

// A GridPlan as bare arrays, for the reason that SweepTables are. Rows of coefficients stand in `numbers` by the line,
// [3][width] each; rows that are alike are one.
template <class Real>
struct GridTables {
  std::uint32_t rows = 0;
  std::uint32_t columns = 0;
  std::uint32_t width = 0;
  std::uint32_t margin = 0;             // on either side of a row of forces, always 0: forceWidth is width + 2 margin
  const Real* inverseMasses = nullptr;  // [row][width]; 0: fixed, or no vertex
  const Real* numbers = nullptr;
  std::uint32_t directionCount = 0;
  const GridDirection* directions = nullptr;  // of springs, ascending in what they add to a vertex's number
  // [row][direction]: where k, k r and c of the springs that begin there stand in `numbers`; kNoGridRow: none does.
  const std::uint32_t* springRows = nullptr;
  // [row]: likewise ½ρC/6 of the first and the second triangle, and above 0 where they are cut from b to d.
  const std::uint32_t* squareRows = nullptr;
  GridSquares squares;
  bool planar = false;
  bool hasDrag = false;
};

}  // namespace wobble::physics
