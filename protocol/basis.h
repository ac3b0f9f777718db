// The directions in which a patch is coded: an orthonormal basis of all its coordinates, and how far play goes along
// each.
//
// Sixty modes of the Karhunen–Loève transform, which is what fits beside a ball's blueprint, leave 0.6 % of the size
// unsaid when a ball is squeezed hard, and all 486 of them as bytes would be 236 KB. So the strongest modes are sent,
// as bytes, and both ends complete them: Householder's reflections that turn the first unit vectors into these modes
// turn the others into a basis of the rest, which stays local, and small blocks of it are turned by matrices of four
// bits each into their own principal directions. Against sending as many modes as fit, this saves 0.6 bits a vertex at
// 0.25 % and makes 0.1 % possible at all; against all modes it costs 0.05.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "protocol/limits.h"

namespace wobble::protocol {

struct Basis {
  std::size_t vertices = 0;
  // Each mode moves all coordinates of the patch (x, y, z of the first vertex, of the second …), or one number a vertex
  // and then counts three times, for x, y and z.
  bool isScalar = false;
  std::vector<std::int16_t> columns;  // rows × rows, mode after mode, in 2^-14
  // Of each of the 3 · vertices coefficients; scalar: mode · 3 + axis.
  std::vector<std::int16_t> levels;  // its spread in training, in eighths of an octave of a metre
  std::vector<std::int8_t> gains;    // how much of what contact suggests it follows, in 1/64

  [[nodiscard]] std::size_t Rows() const { return isScalar ? vertices : 3 * vertices; }
  [[nodiscard]] std::span<const std::int16_t> Column(std::size_t mode) const {
    return std::span(columns).subspan(mode * Rows(), Rows());
  }
};

// What is sent of a basis.
struct BasisSource {
  enum class Kind : std::uint8_t { kFull = 0, kScalar = 1, kCosine = 2 };
  Kind kind = Kind::kFull;
  std::uint16_t vertices = 0;
  // Full and scalar: the strongest modes, each of any length but 0, mode after mode; the vertices in the order in which
  // the rest is to be completed, the first of them far from each other, the last in clusters.
  std::vector<std::int8_t> modes;
  std::vector<std::uint16_t> order;
  // Full: matrices of −7 … 7, column after column, one a block of the rest, which is cut into `blocks` equal parts.
  std::uint8_t blocks = 0;
  std::vector<std::int8_t> turns;
  std::array<std::uint16_t, 3> grid{};  // cosine: vertices along each axis, the first running fastest
  std::vector<std::uint8_t> levels;     // kLevelZero: a metre
  std::vector<std::int8_t> gains;
};
inline constexpr int kLevelZero = 192;

// Where block `block` of `rest` modes begins.
[[nodiscard]] constexpr std::size_t FindBlockBegin(std::size_t rest, std::size_t blocks, std::size_t block) {
  return rest * block / blocks;
}

// At most kMaxBasisBytes, which is the caller's to see to.
[[nodiscard]] std::vector<std::uint8_t> WriteBasis(const BasisSource& source);
// Any bytes are safe. nullptr when they are no basis for so many vertices.
[[nodiscard]] std::shared_ptr<const Basis> ReadBasis(std::span<const std::uint8_t> bytes, std::size_t vertices);

}  // namespace wobble::protocol
