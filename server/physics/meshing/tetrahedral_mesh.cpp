// Boxes of whole cubes, and what boxes and filled surfaces share. Inside, four tetrahedra stand round the line between
// two neighbouring centres, one on each edge of the side that the cubes share. Where a cube has no neighbour, the
// pyramid from its centre to that side is cut in two, along diagonals that alternate so that none is favoured.
#include "server/physics/meshing/tetrahedral_mesh.h"

#include <algorithm>
#include <map>

#include "server/physics/meshing/centred_lattice.h"

namespace wobble::physics {
namespace {

// Cuts the pyramids on one outer side of a box.
void AddPyramids(const CentredLattice& lattice, std::size_t axis, bool far, TetrahedralMesh& mesh) {
  const std::size_t u = (axis + 1) % 3;
  const std::size_t v = (axis + 2) % 3;
  LatticePlace p{};
  p[axis] = far ? lattice.cells[axis] - 1 : 0;
  for (p[v] = 0; p[v] < lattice.cells[v]; ++p[v]) {
    for (p[u] = 0; p[u] < lattice.cells[u]; ++p[u]) {
      const std::uint32_t centre = lattice.CentreAt(p);
      const auto square = lattice.CornersOfSide(p, axis, far);
      const std::size_t first = (p[u] + p[v]) % 2 == 0 ? 0 : 1;
      for (const std::size_t half : {first, first + 2}) {
        mesh.tetrahedra.push_back({centre, square[half % 4], square[(half + 1) % 4], square[(half + 2) % 4]});
      }
    }
  }
}

}  // namespace

double FindVolume(std::span<const Vector3d> vertices, const Corners& corners) {
  const Vector3d& origin = vertices[corners[0]];
  return (vertices[corners[1]] - origin).dot((vertices[corners[2]] - origin).cross(vertices[corners[3]] - origin)) / 6;
}

std::size_t CountBoxVertices(const std::array<int, 3>& cells) {
  std::size_t corners = 1;
  std::size_t centres = 1;
  for (const int n : cells) {
    corners *= static_cast<std::size_t>(n) + 1;
    centres *= static_cast<std::size_t>(n);
  }
  return corners + centres;
}

TetrahedralMesh FillBox(const std::array<int, 3>& cells, double cellSize) {
  const CentredLattice lattice{cells};
  TetrahedralMesh mesh;
  lattice.VisitVertices([&](const Vector3d& place) { mesh.vertices.push_back(cellSize * place); });
  lattice.VisitTetrahedra([&](const Corners& corners) { mesh.tetrahedra.push_back(corners); });
  for (const std::size_t axis : {0U, 1U, 2U}) {
    for (const bool far : {false, true}) AddPyramids(lattice, axis, far, mesh);
  }
  for (Corners& corners : mesh.tetrahedra) {
    if (FindVolume(mesh.vertices, corners) < 0) std::swap(corners[2], corners[3]);
  }
  return mesh;
}

std::vector<Face> FindSkin(const TetrahedralMesh& mesh) {
  constexpr std::array<std::array<std::size_t, 3>, 4> kSides{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};
  std::map<std::array<std::uint32_t, 3>, std::vector<Face>> sides;  // by ascending vertices
  for (const Corners& corners : mesh.tetrahedra) {
    for (const auto& [a, b, c] : kSides) {
      std::array<std::uint32_t, 3> key{corners[a], corners[b], corners[c]};
      const Face face{static_cast<std::uint16_t>(key[0]), static_cast<std::uint16_t>(key[1]),
                      static_cast<std::uint16_t>(key[2])};
      std::ranges::sort(key);
      sides[key].push_back(face);
    }
  }
  std::vector<Face> skin;
  for (const auto& [key, faces] : sides) {
    if (faces.size() == 1) skin.push_back(faces[0]);
  }
  return skin;
}

}  // namespace wobble::physics
