// Solids: a cubic lattice of masses, joined by springs along the edges and diagonals of its cells; and sheets in a
// plane, a square lattice of the same kind.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "server/physics/model/blueprint.h"

namespace wobble::physics {

// Central springs know no inside: hit at more than about a third of √(E/ρ), a lattice may be left with cells that are
// turned inside out (cubes of 2 to 4 cells a side; of six, a fifth).
enum class Side : std::uint8_t { kNone, kLowX, kHighX, kLowY, kHighY, kLowZ, kHighZ };

// No cells along y: a planar lattice, whose quantities are per metre of depth.
struct LatticeDefinition {
  std::string name = "lattice";
  std::array<int, 3> cells{3, 3, 3};  // along x, y, z
  double cellSize = 0.25;             // edge of a cell, a, m
  double youngModulus = 10000;        // E, Pa
  double poissonRatio = 0.25;         // what springs of this kind have (planar: 1/3); no other can be built
  double density = 20;                // kg/m³
  double dampingRatio = 0.1;          // of each spring between two inner masses alone, 1: critical
  double friction = 0.8;              // Coulomb's coefficient, static and kinetic
  double restitution = 0.5;           // of a single vertex on a rigid surface
  double contactStiffness = 0;        // of a vertex against a surface, N/m; 0: kContactStiffnessRatio x stiffness
  double repulsion = 0;      // between neighbours at distance d: this/d⁴, N·m⁴; stiffens beyond youngModulus
  Side fixed = Side::kNone;  // vertices on this side stay where they are
};

inline constexpr int kMaxLatticeCells = 100;  // along an axis
inline constexpr std::size_t kMaxLatticeVertices = 10000;
[[nodiscard]] constexpr std::size_t CountVertices(const std::array<int, 3>& cells) {
  std::size_t count = 1;
  for (const int n : cells) count *= static_cast<std::size_t>(n) + 1;
  return count;
}

[[nodiscard]] constexpr bool IsPlanar(const std::array<int, 3>& cells) { return cells[1] == 0; }
// ν of springs in space and in a plane.
[[nodiscard]] constexpr double FindPoissonRatio(const std::array<int, 3>& cells) {
  return IsPlanar(cells) ? 1.0 / 3 : 0.25;
}

// Everything that is wrong with a definition; empty when it can be built.
[[nodiscard]] std::vector<FieldError> ValidateLattice(const LatticeDefinition& definition);

// The definition must be valid. Vertices with x fastest, then y, then z; faces on the outside only, of a planar one all
// over it, towards −y.
[[nodiscard]] Blueprint MakeLattice(const LatticeDefinition& definition);

}  // namespace wobble::physics
