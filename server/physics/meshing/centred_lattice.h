// The body-centred cubic lattice of tetrahedral_mesh.h: numbers and places of its vertices, and its tetrahedra.
#pragma once

#include <array>
#include <cstdint>
#include <utility>

#include "server/physics/meshing/tetrahedral_mesh.h"
#include "server/physics/model/vector.h"

namespace wobble::physics {

using LatticePlace = std::array<int, 3>;  // of a cube, or of the corner that it begins at

// Lengths are in edges of a cube. Corners come first, x fastest, then y, then z; after them the centres, likewise.
struct CentredLattice {
  LatticePlace cells;

  [[nodiscard]] std::uint32_t CornerAt(const LatticePlace& p) const {
    return static_cast<std::uint32_t>((p[2] * (cells[1] + 1) + p[1]) * (cells[0] + 1) + p[0]);
  }
  [[nodiscard]] std::uint32_t CountCorners() const {
    return static_cast<std::uint32_t>((cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1));
  }
  [[nodiscard]] std::uint32_t CentreAt(const LatticePlace& p) const {
    return CountCorners() + static_cast<std::uint32_t>((p[2] * cells[1] + p[1]) * cells[0] + p[0]);
  }

  // Of the cube's side at its near or far end along the axis, round it.
  [[nodiscard]] Corners CornersOfSide(const LatticePlace& cube, std::size_t axis, bool far) const {
    const std::size_t u = (axis + 1) % 3;
    const std::size_t v = (axis + 2) % 3;
    constexpr std::array<std::pair<int, int>, 4> kRound{{{0, 0}, {1, 0}, {1, 1}, {0, 1}}};
    Corners corners{};
    for (std::size_t i = 0; i < 4; ++i) {
      LatticePlace p = cube;
      p[axis] += far ? 1 : 0;
      p[u] += kRound[i].first;
      p[v] += kRound[i].second;
      corners[i] = CornerAt(p);
    }
    return corners;
  }

  // Calls visit(place) for all vertices in their order.
  template <class Visit>
  void VisitVertices(Visit&& visit) const {
    VisitPlaces(1, [&](const LatticePlace& p) { visit(Vector3d(p[0], p[1], p[2])); });
    VisitPlaces(0, [&](const LatticePlace& p) { visit(Vector3d(p[0] + 0.5, p[1] + 0.5, p[2] + 0.5)); });
  }

  // Calls visit(corners) for the tetrahedra between the centres of neighbouring cubes, whichever way they are wound.
  template <class Visit>
  void VisitTetrahedra(Visit&& visit) const {
    VisitPlaces(0, [&](const LatticePlace& p) {
      for (const std::size_t axis : {0U, 1U, 2U}) {
        LatticePlace next = p;
        if (++next[axis] == cells[axis]) continue;
        const Corners square = CornersOfSide(p, axis, true);
        for (std::size_t i = 0; i < 4; ++i) visit(Corners{CentreAt(p), CentreAt(next), square[i], square[(i + 1) % 4]});
      }
    });
  }

 private:
  // From 0 up to cells + more, not including it, along each axis.
  template <class Visit>
  void VisitPlaces(int more, Visit&& visit) const {
    for (int z = 0; z < cells[2] + more; ++z) {
      for (int y = 0; y < cells[1] + more; ++y) {
        for (int x = 0; x < cells[0] + more; ++x) visit(LatticePlace{x, y, z});
      }
    }
  }
};

}  // namespace wobble::physics
