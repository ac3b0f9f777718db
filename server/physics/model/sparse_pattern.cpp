// Eigen's approximate minimum degree gives the order; the pattern is written out so that numbers can be filled in
// without a search for their place.
#include "server/physics/model/sparse_pattern.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#include <algorithm>
#include <cassert>

namespace wobble::physics {
namespace {

// vertex -> place of its diagonal block.
std::vector<int> FindPlaces(std::span<const std::array<std::uint32_t, 2>> pairs, std::size_t vertexCount) {
  const auto count = static_cast<int>(vertexCount);
  std::vector<Eigen::Triplet<float>> entries;
  for (int i = 0; i < count; ++i) entries.emplace_back(i, i, 1.0F);
  for (const auto& [a, b] : pairs) {
    entries.emplace_back(static_cast<int>(a), static_cast<int>(b), 1.0F);
    entries.emplace_back(static_cast<int>(b), static_cast<int>(a), 1.0F);
  }
  Eigen::SparseMatrix<float> graph(count, count);
  graph.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> vertexAt;
  Eigen::AMDOrdering<int>()(graph, vertexAt);
  std::vector<int> places(vertexCount);
  for (int place = 0; place < count; ++place) places[static_cast<std::size_t>(vertexAt.indices()[place])] = place;
  return places;
}

}  // namespace

SparsePattern MakeSparsePattern(std::span<const std::array<std::uint32_t, 2>> pairs, std::size_t vertexCount) {
  SparsePattern pattern;
  pattern.places = FindPlaces(pairs, vertexCount);
  const auto sort = [&](const std::array<std::uint32_t, 2>& pair) {
    return std::minmax(pattern.places[pair[0]], pattern.places[pair[1]]);
  };
  std::vector<std::vector<int>> above(vertexCount);  // column of blocks -> its rows above the diagonal
  for (const auto& pair : pairs) {
    assert(pair[0] != pair[1] && pair[0] < vertexCount && pair[1] < vertexCount);
    const auto [row, column] = sort(pair);
    above[static_cast<std::size_t>(column)].push_back(row);
  }
  pattern.columnBegins.push_back(0);
  for (std::size_t column = 0; column < vertexCount; ++column) {
    std::vector<int>& blocks = above[column];
    std::sort(blocks.begin(), blocks.end());
    blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
    for (int part = 0; part < 3; ++part) {
      for (const int block : blocks) {
        for (int row = 0; row < 3; ++row) pattern.rows.push_back(3 * block + row);
      }
      for (int row = 0; row <= part; ++row) pattern.rows.push_back(3 * static_cast<int>(column) + row);
      pattern.columnBegins.push_back(static_cast<int>(pattern.rows.size()));
    }
  }
  for (const auto& pair : pairs) {
    const auto [row, column] = sort(pair);
    const std::vector<int>& blocks = above[static_cast<std::size_t>(column)];
    const auto nth = static_cast<int>(std::lower_bound(blocks.begin(), blocks.end(), row) - blocks.begin());
    std::array<int, 3> begins{};
    for (int part = 0; part < 3; ++part) {
      begins[static_cast<std::size_t>(part)] =
          pattern.columnBegins[static_cast<std::size_t>(3 * column + part)] + 3 * nth;
    }
    pattern.pairBlocks.push_back(begins);
  }
  return pattern;
}

}  // namespace wobble::physics
