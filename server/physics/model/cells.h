// The cells of a lattice, and what holds them right side out. The force law is that of methods/unfolding.h.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace wobble::physics {

template <class Real>
struct Cells {
  std::vector<std::uint16_t> first;         // the vertex of least coordinates of each; empty: the body is no lattice
  std::array<std::uint16_t, 3> strides{};   // from a vertex to its neighbours along x, y, z; planar: 0 along y
  std::array<std::vector<Real>, 3> isEdge;  // along each axis, three numbers a vertex: 1 where an edge of a cell begins
  Real edge = 0;                            // a, m
  Real stiffness = 0;                       // K, J
  Real damping = 0;                         // γ, 1/s
  Real cornerMass = 0;         // of each vertex of a corner, if every vertex were shared out among its corners, kg
  double squareFrequency = 0;  // of all corners together, at most, 1/s²
};

}  // namespace wobble::physics
