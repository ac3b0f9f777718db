// Bodies cut into tetrahedra: boxes, and what a closed triangle mesh encloses, both from a body-centred cubic lattice.
// That is the corners and the centres of cubes; an edge joins two neighbouring centres, two neighbouring corners, or a
// centre and a corner of its cube, and every tetrahedron has two centres and two corners. They are all alike, and of
// all tetrahedra that fill space alone the nearest to regular ones.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "server/physics/model/topology.h"
#include "server/physics/model/vector.h"

namespace wobble::physics {

using Corners = std::array<std::uint32_t, 4>;

// Every tetrahedron encloses a positive volume: (x₁ − x₀)·((x₂ − x₀)×(x₃ − x₀)) > 0. Every vertex has one.
struct TetrahedralMesh {
  std::vector<Vector3d> vertices;  // m
  std::vector<Corners> tetrahedra;
};

// A box of cubes with this edge, m, its least corner in the origin. cells: along x, y, z, each at least 1. Its vertices
// are the corners of the cubes, x fastest, then y, then z, and after them the centres.
[[nodiscard]] TetrahedralMesh FillBox(const std::array<int, 3>& cells, double cellSize);
[[nodiscard]] std::size_t CountBoxVertices(const std::array<int, 3>& cells);

// What a closed triangle mesh without faults (mesh.h), wound to look outward, encloses, by a lattice of cubes with this
// edge, m: its surface is followed to about a tenth of that; what is thinner than a cube may be lost. Empty when
// nothing is left. Of several parts the largest is kept. Cost: some 10 ns for each face and lattice edge near the
// surface.
[[nodiscard]] TetrahedralMesh FillSurface(std::span<const Vector3d> vertices, std::span<const Face> faces,
                                          double cellSize);
// The cubes that such a lattice has.
[[nodiscard]] double CountCubes(std::span<const Vector3d> vertices, double cellSize);

// The sides of tetrahedra that no other shares, counter-clockwise seen from outside. For fewer than 65,536 vertices.
[[nodiscard]] std::vector<Face> FindSkin(const TetrahedralMesh& mesh);

// m³; negative where a tetrahedron is inside out.
[[nodiscard]] double FindVolume(std::span<const Vector3d> vertices, const Corners& corners);

}  // namespace wobble::physics
