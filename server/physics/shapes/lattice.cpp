// Builds lattices. A spring of stiffness k and length l along the unit vector n stores ½ k l² (n·ε n)² under a strain
// ε, so springs in a volume V make a material of C_ijkl = (1/V) Σ k l² nᵢ nⱼ nₖ nₗ. A cell of edge a owns three edges
// (l = a), six face diagonals (√2 a) and four body diagonals (√3 a). With stiffnesses (1 + s) K, (1 − s) K and ¾ s K
//   C₁₁ = (1 + s + 2 (1 − s) + s) K/a = 3 K/a,   C₁₂ = C₄₄ = (1 − s + s) K/a = K/a
// for any s: C₁₁ = C₁₂ + 2 C₄₄ is isotropic, E = (C₁₁ − C₁₂)(C₁₁ + 2 C₁₂)/(C₁₁ + C₁₂) = 2.5 K/a and
// ν = C₁₂/(C₁₁ + C₁₂) = 1/4. C₁₂ = C₄₄ (Cauchy's relation) holds for any central springs, hence no other ν.
//
// s = 0 needs the fewest springs, but a corner is then easily pushed through its cell and stays there: a hit at
// 0.1 √(E/ρ) dents a cube of 4³ cells for good. With s = ¼ its corners bear 0.6 √(E/ρ) and any side 0.35; a larger s
// was no better.
//
// In a plane, per metre of depth, a cell owns two edges and two diagonals. With stiffnesses 2 K and K
//   C₁₁ = 2 K + K = 3 K,   C₁₂ = C₄₄ = K:   isotropic, E = C₁₁ − C₁₂²/C₁₁ = 8/3 K and ν = C₁₂/C₁₁ = 1/3.
//
// Each cell adds its own share: ¼ of each of its edges, which four cells share inside, ½ of each face diagonal, which
// two share, and ⅛ of its mass at each corner. All cells are then alike, and a body of any number of them has exactly
// E, ν and the density. Rejected: equal masses. They would give contacts heavier corners, but move mass outward (a cube
// of 3³ cells would have 1.7 times the moment of inertia of a solid one, with shares it has 1.2) and so lower the
// frequencies. Shares cost no substeps, since no body is stiffer for its mass than one cell alone.
#include "server/physics/shapes/lattice.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "server/physics/contact/contact.h"
#include "server/physics/methods/unfolding.h"
#include "server/physics/shapes/finish_blueprint.h"
#include "server/physics/shapes/material.h"
#include "server/physics/shapes/quad.h"

namespace wobble::physics {
namespace {

using Place = std::array<int, 3>;  // of a vertex, in cells from the corner of the lattice

struct Grid {
  Place cells;

  [[nodiscard]] std::uint16_t IndexOf(const Place& p) const {
    return static_cast<std::uint16_t>((p[2] * (cells[1] + 1) + p[1]) * (cells[0] + 1) + p[0]);
  }
  [[nodiscard]] bool Holds(const Place& p) const {
    return std::ranges::equal(p, cells, [](int at, int last) { return at >= 0 && at <= last; });
  }
  [[nodiscard]] bool IsOuter(std::size_t axis, const Place& p) const {
    return cells[axis] > 0 && (p[axis] == 0 || p[axis] == cells[axis]);
  }

  // The share of cells that the lattice has of those that would meet in a vertex, or in a spring that leaves it along
  // `direction`.
  [[nodiscard]] double FindShare(const Place& p, const Place& direction) const {
    double share = 1;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (direction[axis] == 0 && IsOuter(axis, p)) share /= 2;
    }
    return share;
  }

  template <class Visit>
  void VisitPlaces(Visit&& visit) const {
    for (int z = 0; z <= cells[2]; ++z) {
      for (int y = 0; y <= cells[1]; ++y) {
        for (int x = 0; x <= cells[0]; ++x) visit(Place{x, y, z});
      }
    }
  }
};

constexpr double kBodyDiagonals = 0.25;  // s
// Stiffnesses of edges, face diagonals and body diagonals, as multiples of K.
constexpr double kStiffnesses[] = {1 + kBodyDiagonals, 1 - kBodyDiagonals, 0.75 * kBodyDiagonals};
constexpr double kPlanarStiffnesses[] = {2, 1};

// Half of the directions in which springs leave a vertex; the springs of the other half belong to the neighbours.
constexpr Place kDirections[] = {{1, 0, 0}, {0, 1, 0},  {0, 0, 1}, {1, 1, 0},  {-1, 1, 0}, {1, 0, 1},  {-1, 0, 1},
                                 {0, 1, 1}, {0, -1, 1}, {1, 1, 1}, {-1, 1, 1}, {1, -1, 1}, {-1, -1, 1}};

double FindStiffness(const LatticeDefinition& d) {  // K
  return IsPlanar(d.cells) ? d.youngModulus * 3 / 8 : d.youngModulus * d.cellSize / 2.5;
}
double FindCellMass(const LatticeDefinition& d) {
  return d.density * d.cellSize * d.cellSize * (IsPlanar(d.cells) ? 1 : d.cellSize);
}

// The damping of each spring is proportional to its stiffness, so that the damping of a mode depends only on its
// frequency.
void AddVertexSprings(const Grid& grid, const Place& p, const LatticeDefinition& definition,
                      std::vector<Spring<double>>& springs) {
  const double stiffness = FindStiffness(definition);
  const double damping = FindDamping(definition.dampingRatio, stiffness, FindCellMass(definition));
  const double* stiffnesses = IsPlanar(definition.cells) ? kPlanarStiffnesses : kStiffnesses;
  for (const Place& direction : kDirections) {
    const Place q{p[0] + direction[0], p[1] + direction[1], p[2] + direction[2]};
    if (!grid.Holds(q)) continue;
    const int squares = direction[0] * direction[0] + direction[1] * direction[1] + direction[2] * direction[2];
    const double share = grid.FindShare(p, direction) * stiffnesses[squares - 1];
    springs.push_back({.a = grid.IndexOf(p),
                       .b = grid.IndexOf(q),
                       .restLength = std::sqrt(squares) * definition.cellSize,
                       .stiffness = share * stiffness,
                       .damping = share * damping});
  }
}

// Adds two triangles for each square of an outer side, cut along alternating diagonals so that no direction is
// favoured.
void AddSide(const Grid& grid, std::size_t axis, bool far, std::vector<Face>& faces) {
  const std::size_t u = (axis + 1) % 3;  // u × v looks along the axis
  const std::size_t v = (axis + 2) % 3;
  Place p{};
  p[axis] = far ? grid.cells[axis] : 0;
  for (p[u] = 0; p[u] < grid.cells[u]; ++p[u]) {
    for (p[v] = 0; p[v] < grid.cells[v]; ++p[v]) {
      const auto corner = [&](int du, int dv) {
        Place q = p;
        q[u] += du;
        q[v] += dv;
        return grid.IndexOf(q);
      };
      std::array<std::uint16_t, 4> square{corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
      if (!far) std::swap(square[1], square[3]);
      const auto& [a, b, c, d] = square;
      AddQuad(a, b, c, d, (p[u] + p[v]) % 2 != 0, faces);
    }
  }
}

// The contact law damps for one mass: the mean of those that can touch, which are from ⅛ (corner) to ½ (face) of a
// cell.
double FindMeanOuterMass(const Grid& grid, const std::vector<double>& masses) {
  double sum = 0;
  int count = 0;
  grid.VisitPlaces([&](const Place& p) {
    if (!grid.IsOuter(0, p) && !grid.IsOuter(1, p) && !grid.IsOuter(2, p)) return;
    sum += masses[grid.IndexOf(p)];
    ++count;
  });
  return sum / count;
}

void FixSide(const Grid& grid, Side side, std::vector<std::uint16_t>& fixed) {
  if (side == Side::kNone) return;
  const auto index = static_cast<std::size_t>(side) - static_cast<std::size_t>(Side::kLowX);
  const std::size_t axis = index / 2;
  const int at = index % 2 == 0 ? 0 : grid.cells[axis];
  grid.VisitPlaces([&](const Place& p) {
    if (p[axis] == at) fixed.push_back(grid.IndexOf(p));
  });
}

// Half of the shortest way through the body, m.
double FindHalfWidth(const LatticeDefinition& d) {
  int fewest = kMaxLatticeCells;
  for (const int n : d.cells) {
    if (n > 0) fewest = std::min(fewest, n);
  }
  return d.cellSize * fewest / 2;
}

std::string FormatCells(const std::array<int, 3>& cells) {
  return "[" + std::to_string(cells[0]) + ", " + std::to_string(cells[1]) + ", " + std::to_string(cells[2]) + "]";
}

void CheckCells(std::vector<FieldError>& errors, const std::array<int, 3>& cells) {
  const auto isGood = [](int n, int least) { return n >= least && n <= kMaxLatticeCells; };
  if (!isGood(cells[0], 1) || !isGood(cells[1], 0) || !isGood(cells[2], 1)) {
    errors.push_back(
        {"cells", FormatCells(cells),
         "three whole numbers from 1 to " + std::to_string(kMaxLatticeCells) + ", or the second 0: a planar lattice"});
  } else if (CountVertices(cells) > kMaxLatticeVertices) {
    errors.push_back({"cells", FormatCells(cells),
                      "fewer: " + std::to_string(CountVertices(cells)) + " vertices; at most " +
                          std::to_string(kMaxLatticeVertices)});
  }
}

}  // namespace

std::vector<FieldError> ValidateLattice(const LatticeDefinition& d) {
  std::vector<FieldError> errors;
  CheckCells(errors, d.cells);
  CheckField(errors, "cell_size", d.cellSize, d.cellSize >= 0.02 && d.cellSize <= 50, "0.02 to 50 m");
  CheckField(errors, "young_modulus", d.youngModulus, d.youngModulus > 0 && d.youngModulus <= 1e12,
             "above 0, up to 1e12 Pa");
  CheckField(errors, "poisson_ratio", d.poissonRatio, std::fabs(d.poissonRatio - FindPoissonRatio(d.cells)) < 1e-3,
             IsPlanar(d.cells) ? "1/3 (0.333): a lattice of central springs has no other in 2-D"
                               : "0.25: a lattice of central springs has no other in 3-D");
  CheckField(errors, "density", d.density, d.density >= 0.1 && d.density <= 1e5, "0.1 to 100000 kg/m³");
  CheckField(errors, "damping_ratio", d.dampingRatio, d.dampingRatio >= 0 && d.dampingRatio <= 2, "0 to 2");
  CheckField(errors, "friction", d.friction, d.friction >= 0 && d.friction <= 10, "0 to 10");
  CheckRollingResistance(errors, d.rollingResistance);
  CheckField(errors, "restitution", d.restitution, d.restitution >= 0 && d.restitution <= 1, "0 to 1");
  CheckField(errors, "contact_stiffness", d.contactStiffness, d.contactStiffness >= 0 && d.contactStiffness <= 1e9,
             "0 (ten times that of an edge's spring) to 1e9 N/m");
  CheckField(errors, "repulsion", d.repulsion, d.repulsion >= 0 && d.repulsion <= 1e6, "0 to 1e6 N·m⁴");
  if (IsPlanar(d.cells) && (d.fixed == Side::kLowY || d.fixed == Side::kHighY)) {
    errors.push_back({"fixed", d.fixed == Side::kLowY ? "y-" : "y+", "a side of a planar lattice: x-, x+, z-, z+"});
  }
  if (!errors.empty()) return errors;

  const Blueprint lattice = MakeLattice(d);
  CheckField(errors, "repulsion", d.repulsion, d.repulsion == 0 || HasLongEnoughSprings(lattice),
             "lower, or young_modulus higher: springs that balance it would vanish");
  CheckField(errors, "young_modulus", d.youngModulus, IsSlowEnough(lattice),
             "lower, or contact_stiffness lower, or density or cell_size higher: the body would need more than 32 "
             "substeps a tick before it touches anything, or more than 64 on the ground");
  return errors;
}

Blueprint MakeLattice(const LatticeDefinition& definition) {
  assert(CountVertices(definition.cells) <= kMaxLatticeVertices);
  const Grid grid{definition.cells};
  const double a = definition.cellSize;

  Blueprint blueprint;
  blueprint.name = definition.name;
  grid.VisitPlaces([&](const Place& p) {
    blueprint.rest.push_back(a * Vector3d(p[0], p[1], p[2]));
    blueprint.full.masses.push_back(FindCellMass(definition) * grid.FindShare(p, {0, 0, 0}));
    AddVertexSprings(grid, p, definition, blueprint.full.springs);
  });
  blueprint.grid = {static_cast<std::uint32_t>(definition.cells[0]) + 1,
                    static_cast<std::uint32_t>(definition.cells[1]) + 1,
                    static_cast<std::uint32_t>(definition.cells[2]) + 1};
  blueprint.full.planar = IsPlanar(definition.cells);
  for (const std::size_t axis : {0U, 1U, 2U}) {
    AddSide(grid, axis, false, blueprint.full.faces);
    if (!blueprint.full.planar) AddSide(grid, axis, true, blueprint.full.faces);
  }
  FixSide(grid, definition.fixed, blueprint.full.fixed);
  SetRepulsion(blueprint, definition.repulsion);

  Material material;
  material.stiffness = FindStiffness(definition);
  material.friction = definition.friction;
  material.rollingResistance = definition.rollingResistance;
  material.restitution = definition.restitution;
  material.contactStiffness = definition.contactStiffness;
  blueprint.full.contact =
      MakeContactParameters(material, FindMeanOuterMass(grid, blueprint.full.masses), FindHalfWidth(definition));
  FinishBlueprint(blueprint);
  SetCells(blueprint, MakeCells(blueprint, a, FindCellMass(definition)));
  SetAim(blueprint);
  return blueprint;
}

}  // namespace wobble::physics
