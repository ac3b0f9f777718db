// The basis that a patch is coded in: orthonormal modes of all its coordinates, and how far bodies move along each.
//
// Sixty modes of the Karhunen–Loève transform, which fit beside a ball's blueprint, leave an error of 0.6 % of the size
// when a ball is squeezed hard; all 486 modes as bytes would be 236 KB. So the strongest modes are sent as bytes, and
// both ends complete them: the Householder reflections that turn the first unit vectors into these modes turn the other
// unit vectors into a basis of the remaining space, whose modes stay local. Small blocks of it are then rotated into
// their principal directions by matrices with four bits an entry. Against sending as many modes as fit, this saves 0.6
// bits a vertex at a target of 0.25 % and makes 0.1 % possible at all; against all modes it costs 0.05 bits a vertex.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "protocol/limits.h"

namespace wobble::protocol {

struct Basis {
  // Tells bases that were read apart, for what is computed of them and kept; 0: nothing is.
  std::uint64_t serial = 0;
  std::size_t vertices = 0;
  // False: a mode has a number for each coordinate of the patch (x, y, z of the first vertex, of the second …). True:
  // it has one number a vertex and serves three times, for x, y and z.
  bool isScalar = false;
  std::vector<std::int16_t> columns;  // rows × rows, mode after mode, in units of 2^-14
  // The same by pairs of modes: the entries of modes 2p and 2p + 1 in row i are at 2 (p · rows + i) and behind it. Of
  // an odd number of modes the last one's neighbour is 0.
  std::vector<std::int16_t> pairs;
  // One for each of the 3 · vertices coefficients; scalar: at mode · 3 + axis.
  std::vector<std::int16_t> levels;  // spread in training, in eighths of an octave of a metre
  std::vector<std::int8_t> gains;    // share of the contact prediction that it follows, in 1/64

  [[nodiscard]] std::size_t Rows() const { return isScalar ? vertices : 3 * vertices; }
  [[nodiscard]] std::span<const std::int16_t> Pair(std::size_t pair) const {
    return std::span(pairs).subspan(2 * pair * Rows(), 2 * Rows());
  }
  [[nodiscard]] std::span<const std::int16_t> Column(std::size_t mode) const {
    return std::span(columns).subspan(mode * Rows(), Rows());
  }
};

// The part of a basis that is sent, and from which both ends make a Basis.
struct BasisSource {
  enum class Kind : std::uint8_t { kFull = 0, kScalar = 1, kCosine = 2 };
  Kind kind = Kind::kFull;
  std::uint16_t vertices = 0;
  // Full and scalar: the strongest modes, each of any length but 0, mode after mode; and the vertices in the order in
  // which the basis is completed, the first far from each other, the last in clusters.
  std::vector<std::int8_t> modes;
  std::vector<std::uint16_t> order;
  // Full: matrices of −7 … 7, column after column, one for each block. The completed modes are cut into `blocks` parts
  // of equal size.
  std::uint8_t blocks = 0;
  std::vector<std::int8_t> turns;
  std::array<std::uint16_t, 3> grid{};  // cosine: vertices along each axis, the first running fastest
  std::vector<std::uint8_t> levels;     // Basis::levels + kLevelZero
  std::vector<std::int8_t> gains;       // Basis::gains

  [[nodiscard]] std::size_t CountRows() const { return kind == Kind::kFull ? std::size_t{3} * vertices : vertices; }
};
inline constexpr int kLevelZero = 192;  // the level of a metre, as sent

// The first mode of block `block` when `rest` modes are cut into `blocks`.
[[nodiscard]] constexpr std::size_t FindBlockBegin(std::size_t rest, std::size_t blocks, std::size_t block) {
  return rest * block / blocks;
}

// Serialises a source. The caller sees to it that the result has at most kMaxBasisBytes.
[[nodiscard]] std::vector<std::uint8_t> WriteBasis(const BasisSource& source);

}  // namespace wobble::protocol
