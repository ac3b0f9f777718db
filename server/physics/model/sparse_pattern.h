// The sparsity pattern of the Jacobian of a body's springs: computed once, shared by every body of a blueprint.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace wobble::physics {

// The upper triangle of a symmetric matrix of 3×3 blocks, one row of blocks a vertex, in compressed columns. Vertices
// are reordered, whole blocks at a time, so that factorising fills in little (Amestoy, Davis & Duff 1996).
struct SparsePattern {
  std::vector<int> places;                     // vertex -> its place among the blocks
  std::vector<int> columnBegins;               // where each of the 3n columns begins in `rows`, and the end
  std::vector<int> rows;                       // row of each entry, ascending within a column
  std::vector<std::array<int, 3>> pairBlocks;  // by pair: where its block begins in each of the block's three columns

  // Where the upper triangle of a vertex's own block begins in its column 0, 1 or 2, which has 1, 2 or 3 entries.
  [[nodiscard]] int FindDiagonal(std::size_t vertex, int column) const {
    return columnBegins[static_cast<std::size_t>(3 * places[vertex] + column + 1)] - (column + 1);
  }
};

// pairs: vertices that act on one another, two different ones each, below vertexCount, in any order; a pair may come
// more than once.
[[nodiscard]] SparsePattern MakeSparsePattern(std::span<const std::array<std::uint32_t, 2>> pairs,
                                              std::size_t vertexCount);

}  // namespace wobble::physics
