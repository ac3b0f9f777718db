// Fills closed surfaces with tetrahedra after the idea of isosurface stuffing (Labelle & Shewchuk 2007). Vertices of a
// lattice are inside or outside; where an edge joins one of each, the surface cuts it. A vertex that is near a cut is
// moved there and is then on the surface. What remains of cuts is far from both ends of its edge, so a tetrahedron that
// is cut there has no needles: it is replaced by the part of it that is inside, one, two or three tetrahedra.
//
// What differs from them: a vertex is inside by the surface's windings round it, not by a function of distance; and
// four- sided faces are cut in two along the diagonal of the vertex with the least number, which neighbours agree about
// without a rule of parity (Dompierre et al. 1999). The bound on angles that they prove is not proved for that; what it
// comes to is measured in tests.
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include "server/physics/meshing/centred_lattice.h"
#include "server/physics/meshing/tetrahedral_mesh.h"

namespace wobble::physics {
namespace {

// Nearer than this share of an edge's length a cut draws the edge's end to itself: edges between centres or between
// corners, which are the longer ones, and edges from a centre to a corner. Larger shares would let vertices move so far
// that tetrahedra become flat.
constexpr double kDrawnLong = 0.25;
constexpr double kDrawnShort = 0.41;

using Segment = std::array<std::uint32_t, 2>;  // the two ends, the lesser number first

// The triangles of a closed surface, with the boxes round them.
class Shell {
 public:
  Shell(std::span<const Vector3d> vertices, std::span<const Face> faces) {
    for (const auto& [a, b, c] : faces) {
      const auto& [p, q, r] = m_triangles.emplace_back(std::array{vertices[a], vertices[b], vertices[c]});
      m_low.push_back(p.cwiseMin(q).cwiseMin(r));
      m_high.push_back(p.cwiseMax(q).cwiseMax(r));
    }
  }

  // Whether the surface winds round the point: by what a ray upwards crosses.
  [[nodiscard]] bool Encloses(const Vector3d& point) const {
    int windings = 0;
    for (std::size_t i = 0; i < m_triangles.size(); ++i) {
      if (point.z() > m_high[i].z() || point.x() < m_low[i].x() || point.x() > m_high[i].x() ||
          point.y() < m_low[i].y() || point.y() > m_high[i].y()) {
        continue;
      }
      const auto hit = FindHit(i, point, Vector3d::UnitZ());
      if (!hit || *hit < 0) continue;
      const auto& [p, q, r] = m_triangles[i];
      windings += (q - p).cross(r - p).z() > 0 ? 1 : -1;
    }
    return windings > 0;
  }

  // The first place on the way from `from` to `to` where the surface is crossed, as a share of it; ½ where rounding
  // hides the crossing.
  [[nodiscard]] double FindFirstCrossing(const Vector3d& from, const Vector3d& to) const {
    const Vector3d low = from.cwiseMin(to);
    const Vector3d high = from.cwiseMax(to);
    double first = 2;
    for (std::size_t i = 0; i < m_triangles.size(); ++i) {
      if ((m_low[i].array() > high.array()).any() || (m_high[i].array() < low.array()).any()) continue;
      const auto hit = FindHit(i, from, to - from);
      if (hit && *hit >= 0 && *hit <= 1) first = std::min(first, *hit);
    }
    return first > 1 ? 0.5 : first;
  }

 private:
  // t of the point from + t · way in the triangle, if there is one (Möller & Trumbore 1997).
  [[nodiscard]] std::optional<double> FindHit(std::size_t triangle, const Vector3d& from, const Vector3d& way) const {
    const auto& [p, q, r] = m_triangles[triangle];
    const Vector3d side = way.cross(r - p);
    const double determinant = side.dot(q - p);
    if (determinant == 0) return std::nullopt;
    const Vector3d offset = from - p;
    const double u = offset.dot(side) / determinant;
    const Vector3d across = offset.cross(q - p);
    const double v = way.dot(across) / determinant;
    if (u < 0 || v < 0 || u + v > 1) return std::nullopt;
    return (r - p).dot(across) / determinant;
  }

  std::vector<std::array<Vector3d, 3>> m_triangles;
  std::vector<Vector3d> m_low;
  std::vector<Vector3d> m_high;
};

// A lattice round a surface that is warped to it and cut along it.
class Stuffing {
 public:
  Stuffing(const Shell& shell, const CentredLattice& lattice, const Vector3d& origin, double cellSize)
      : m_lattice(lattice), m_cellSize(cellSize) {
    lattice.VisitVertices([&](const Vector3d& place) {
      m_places.push_back(origin + cellSize * place);
      m_signs.push_back(shell.Encloses(m_places.back()) ? 1 : -1);
    });
    FindCuts(shell);
    for (std::uint32_t i = 0; i < m_signs.size(); ++i) Warp(i);
    for (const auto& [edge, cut] : m_cuts) {
      m_numbers[edge] = static_cast<std::uint32_t>(m_places.size());
      m_places.push_back(cut);
    }
    lattice.VisitTetrahedra([this](const Corners& corners) { AddInside(corners); });
  }

  // Vertices that no tetrahedron has are among them.
  [[nodiscard]] TetrahedralMesh Take() { return {std::move(m_places), std::move(m_tetrahedra)}; }

 private:
  static Segment Join(std::uint32_t a, std::uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

  void FindCuts(const Shell& shell) {
    m_cutsOf.resize(m_places.size());
    m_lattice.VisitTetrahedra([&](const Corners& corners) {
      for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = i + 1; j < 4; ++j) {
          const Segment edge = Join(corners[i], corners[j]);
          if (m_signs[edge[0]] == m_signs[edge[1]] || m_cuts.contains(edge)) continue;
          const bool isFirstInside = m_signs[edge[0]] > 0;
          const Vector3d& inside = m_places[edge[isFirstInside ? 0 : 1]];
          const Vector3d& outside = m_places[edge[isFirstInside ? 1 : 0]];
          m_cuts[edge] = inside + shell.FindFirstCrossing(inside, outside) * (outside - inside);
          for (const std::uint32_t end : edge) m_cutsOf[end].push_back(edge);
        }
      }
    });
  }

  // Moves a vertex to the nearest of the cuts that are too near to it; the edges at it are then cut no more.
  void Warp(std::uint32_t vertex) {
    const auto isCentre = [this](std::uint32_t i) { return i >= m_lattice.CountCorners(); };
    const Segment* nearest = nullptr;
    double least = m_cellSize;
    for (const Segment& edge : m_cutsOf[vertex]) {
      const auto cut = m_cuts.find(edge);
      if (cut == m_cuts.end()) continue;
      const bool isLong = isCentre(edge[0]) == isCentre(edge[1]);
      const double reach = isLong ? kDrawnLong * m_cellSize : kDrawnShort * std::sqrt(0.75) * m_cellSize;
      const double distance = (cut->second - m_places[vertex]).norm();
      if (distance >= reach || distance >= least) continue;
      least = distance;
      nearest = &edge;
    }
    if (nearest == nullptr) return;
    m_places[vertex] = m_cuts.at(*nearest);
    m_signs[vertex] = 0;
    for (const Segment& edge : m_cutsOf[vertex]) m_cuts.erase(edge);
  }

  // Adds the part of a tetrahedron of the lattice that is inside.
  void AddInside(const Corners& corners) {
    std::vector<std::uint32_t> in, on, out;
    for (const std::uint32_t corner : corners) {
      (m_signs[corner] > 0 ? in : m_signs[corner] == 0 ? on : out).push_back(corner);
    }
    if (in.empty()) return;
    const auto cut = [this](std::uint32_t a, std::uint32_t b) { return m_numbers.at(Join(a, b)); };
    if (out.empty()) {
      Add(corners);
    } else if (in.size() == 1) {
      Corners kept{in[0]};
      std::size_t next = 1;
      for (const std::uint32_t vertex : on) kept[next++] = vertex;
      for (const std::uint32_t vertex : out) kept[next++] = cut(in[0], vertex);
      Add(kept);
    } else if (in.size() == 3) {
      AddPrism({in[0], in[1], in[2]}, {cut(in[0], out[0]), cut(in[1], out[0]), cut(in[2], out[0])});
    } else if (out.size() == 2) {
      AddPrism({in[0], cut(in[0], out[0]), cut(in[0], out[1])}, {in[1], cut(in[1], out[0]), cut(in[1], out[1])});
    } else {
      AddPyramid({in[0], in[1], cut(in[1], out[0]), cut(in[0], out[0])}, on[0]);
    }
  }

  void AddPyramid(const Corners& base, std::uint32_t top) {
    const std::size_t least = std::min_element(base.begin(), base.end()) - base.begin();
    const auto at = [&](std::size_t i) { return base[(least + i) % 4]; };
    Add({at(0), at(1), at(2), top});
    Add({at(0), at(2), at(3), top});
  }

  // The sides of the prism are (near[i], near[j], far[j], far[i]).
  void AddPrism(std::array<std::uint32_t, 3> near, std::array<std::uint32_t, 3> far) {
    if (*std::ranges::min_element(far) < *std::ranges::min_element(near)) std::swap(near, far);
    const std::size_t least = std::ranges::min_element(near) - near.begin();
    const auto p = [&](std::size_t i) { return near[(least + i) % 3]; };
    const auto q = [&](std::size_t i) { return far[(least + i) % 3]; };
    Add({p(0), q(0), q(1), q(2)});
    if (std::min(p(1), q(2)) < std::min(p(2), q(1))) {
      Add({p(0), p(1), p(2), q(2)});
      Add({p(0), p(1), q(1), q(2)});
    } else {
      Add({p(0), p(1), p(2), q(1)});
      Add({p(0), p(2), q(1), q(2)});
    }
  }

  void Add(Corners corners) {
    if (FindVolume(m_places, corners) < 0) std::swap(corners[2], corners[3]);
    m_tetrahedra.push_back(corners);
  }

  CentredLattice m_lattice;
  double m_cellSize;
  std::vector<Vector3d> m_places;
  std::vector<int> m_signs;            // of the lattice's vertices: 1 inside, 0 on the surface, −1 outside
  std::map<Segment, Vector3d> m_cuts;  // where the surface cuts the edges that it cuts
  std::vector<std::vector<Segment>> m_cutsOf;
  std::map<Segment, std::uint32_t> m_numbers;  // of the vertices that cuts become
  std::vector<Corners> m_tetrahedra;
};

// For each tetrahedron the first of those that it hangs together with by whole sides.
std::vector<std::size_t> FindParts(const std::vector<Corners>& tetrahedra) {
  std::vector<std::size_t> root(tetrahedra.size());
  std::iota(root.begin(), root.end(), std::size_t{0});
  const auto find = [&](std::size_t i) {
    while (root[i] != i) i = root[i] = root[root[i]];
    return i;
  };
  std::map<std::array<std::uint32_t, 3>, std::size_t> seen;
  for (std::size_t i = 0; i < tetrahedra.size(); ++i) {
    for (std::size_t left = 0; left < 4; ++left) {
      std::array<std::uint32_t, 3> side{};
      for (std::size_t k = 0; k < 3; ++k) side[k] = tetrahedra[i][(left + 1 + k) % 4];
      std::ranges::sort(side);
      const auto [other, isNew] = seen.emplace(side, i);
      if (!isNew) root[std::max(find(i), find(other->second))] = std::min(find(i), find(other->second));
    }
  }
  for (std::size_t i = 0; i < root.size(); ++i) root[i] = find(i);
  return root;
}

void KeepLargestPart(TetrahedralMesh& mesh) {
  const std::vector<std::size_t> parts = FindParts(mesh.tetrahedra);
  std::map<std::size_t, double> volumes;
  for (std::size_t i = 0; i < parts.size(); ++i) volumes[parts[i]] += FindVolume(mesh.vertices, mesh.tetrahedra[i]);
  const auto largest = std::ranges::max_element(volumes, {}, [](const auto& part) { return part.second; });
  if (largest == volumes.end()) return;
  std::vector<Corners> kept;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i] == largest->first) kept.push_back(mesh.tetrahedra[i]);
  }
  mesh.tetrahedra = std::move(kept);
}

// Drops vertices without a tetrahedron; the others keep their order.
void DropUnused(TetrahedralMesh& mesh) {
  std::vector<std::uint32_t> places(mesh.vertices.size(), 0);
  for (const Corners& corners : mesh.tetrahedra) {
    for (const std::uint32_t corner : corners) places[corner] = 1;
  }
  std::vector<Vector3d> kept;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i] == 0) continue;
    places[i] = static_cast<std::uint32_t>(kept.size());
    kept.push_back(mesh.vertices[i]);
  }
  mesh.vertices = std::move(kept);
  for (Corners& corners : mesh.tetrahedra) {
    for (std::uint32_t& corner : corners) corner = places[corner];
  }
}

struct Extent {
  Vector3d low;
  Vector3d high;
};

Extent FindExtent(std::span<const Vector3d> vertices) {
  Extent extent{vertices[0], vertices[0]};
  for (const Vector3d& x : vertices) extent = {extent.low.cwiseMin(x), extent.high.cwiseMax(x)};
  return extent;
}

}  // namespace

double CountCubes(std::span<const Vector3d> vertices, double cellSize) {
  const Extent extent = FindExtent(vertices);
  return ((extent.high - extent.low) / cellSize + Vector3d::Constant(4)).prod();
}

// The lattice has a cube and a half to spare on each side. Odd shares of a cube keep its vertices off the round numbers
// at which surfaces like to lie.
TetrahedralMesh FillSurface(std::span<const Vector3d> vertices, std::span<const Face> faces, double cellSize) {
  const Extent extent = FindExtent(vertices);
  const Vector3d origin = extent.low - cellSize * Vector3d(1.618034, 1.541196, 1.577350);
  const Vector3d cubes = (extent.high - origin) / cellSize + Vector3d::Constant(1.5);
  CentredLattice lattice{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    lattice.cells[axis] = static_cast<int>(std::ceil(cubes[static_cast<int>(axis)]));
  }
  TetrahedralMesh mesh = Stuffing(Shell(vertices, faces), lattice, origin, cellSize).Take();
  KeepLargestPart(mesh);
  DropUnused(mesh);
  return mesh;
}

}  // namespace wobble::physics
