// Where the Jacobian of a body's springs has entries: once per topology, shared by every body of a blueprint.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace wobble::physics {

// The upper triangle of a symmetric matrix of 3×3 blocks, one row of blocks a vertex, compressed by columns. Vertices
// are put in an order that fills in little when it is factorised (Amestoy, Davis & Duff 1996), whole blocks at a time.
struct SparsePattern {
  std::vector<int> places;                     // of each vertex among the blocks
  std::vector<int> columnBegins;               // of each of the 3n columns in `rows`, and their end
  std::vector<int> rows;                       // ascending within a column
  std::vector<std::array<int, 3>> pairBlocks;  // where the block of each pair begins, in each of its three columns

  // Where the upper half of a vertex's own block begins in its column 0, 1, 2 of 1, 2, 3 entries.
  [[nodiscard]] int FindDiagonal(std::size_t vertex, int column) const {
    return columnBegins[static_cast<std::size_t>(3 * places[vertex] + column + 1)] - (column + 1);
  }
};

// pairs: vertices that act on one another, in any order; the same two may come again.
[[nodiscard]] SparsePattern MakeSparsePattern(std::span<const std::array<std::uint32_t, 2>> pairs,
                                              std::size_t vertexCount);

}  // namespace wobble::physics
