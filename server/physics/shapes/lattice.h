// Lattices: solids of masses in a cubic lattice, joined by springs along the edges and diagonals of its cells; and, in
// a plane, sheets of a square lattice of the same kind.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "server/physics/model/blueprint.h"

namespace wobble::physics {

enum class Side : std::uint8_t { kNone, kLowX, kHighX, kLowY, kHighY, kLowZ, kHighZ };

// With no cells along y the lattice is planar and its quantities are per metre of depth.
//
// Central springs do not tell inside from outside. A cube of 2 to 4 cells a side that hits something at more than about
// a third of √(E/ρ) (of six cells: a fifth) has cells that are turned inside out, until methods/unfolding.h has them
// back.
struct LatticeDefinition {
  std::string name = "lattice";
  std::array<int, 3> cells{3, 3, 3};  // along x, y, z
  double cellSize = 0.25;             // edge of a cell, a, m
  double youngModulus = 10000;        // E, Pa
  double poissonRatio = 0.25;         // must be that of such springs, 1/4 (planar: 1/3); no other can be built
  double density = 20;                // kg/m³
  double dampingRatio = 0.1;          // of a spring between two inner masses by itself; 1: critical
  double friction = 0.8;              // Coulomb's coefficient, static and kinetic
  double rollingResistance = 0.03;    // moment on a body that rolls, over normal force and size
  double restitution = 0.5;           // of a single vertex on a rigid surface
  double contactStiffness = 0;        // of a vertex against a surface, N/m; 0: kContactStiffnessRatio x stiffness
  double repulsion = 0;      // K_r, N·m⁴: neighbours at distance d repel with K_r/d⁴; stiffens beyond youngModulus
  Side fixed = Side::kNone;  // vertices on this side are fixed
};

inline constexpr int kMaxLatticeCells = 100;  // along an axis
inline constexpr std::size_t kMaxLatticeVertices = 10000;
[[nodiscard]] constexpr std::size_t CountVertices(const std::array<int, 3>& cells) {
  std::size_t count = 1;
  for (const int n : cells) count *= static_cast<std::size_t>(n) + 1;
  return count;
}

[[nodiscard]] constexpr bool IsPlanar(const std::array<int, 3>& cells) { return cells[1] == 0; }
// ν of central springs in space or in a plane.
[[nodiscard]] constexpr double FindPoissonRatio(const std::array<int, 3>& cells) {
  return IsPlanar(cells) ? 1.0 / 3 : 0.25;
}

// Lists every bad field of a definition; empty when it can be built.
[[nodiscard]] std::vector<FieldError> ValidateLattice(const LatticeDefinition& definition);

// The definition must be valid. Vertices run along x fastest, then y, then z. Faces lie on the outside; of a planar
// lattice they cover all of it and look towards −y.
[[nodiscard]] Blueprint MakeLattice(const LatticeDefinition& definition);

}  // namespace wobble::physics
