// Random bodies of every kind and any size up to the requested vertex count, with materials over three decades of
// stiffness below what the substeps can hold. A stiffness is drawn by way of the substeps that the body needs by
// itself, uniform in the logarithm, so that small and large, light and heavy bodies all range from soft to stiff. The
// estimate is not exact: of the bodies near the upper end Validate refuses some, and they are drawn again.
//
// Validate is the one that scenes use: what it accepts may stand in a scene file, so the engine must hold it.
#include "tests/bench/stability/random_bodies.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "server/physics/methods/stability.h"

namespace wobble::bench {
namespace {

using namespace physics;

// The most substeps that a body may need by itself according to Validate, and slightly more.
constexpr double kMostSubsteps = 36;
constexpr double kDecades = 3;  // of stiffness
constexpr double kTickHz = 60;

double DrawDamping(Random& random) { return random.Happens(0.15) ? 0 : random.DrawMagnitude(0.02, 2); }

// Draws the stiffness of springs with this damping between masses of `vertexMass`, kg.
double DrawStiffness(Random& random, double fastest, double vertexMass, double dampingRatio) {
  const double substeps = random.DrawMagnitude(kMostSubsteps * std::pow(10, -kDecades / 2), kMostSubsteps);
  // γ = (c/k) ω² with c = 2ζ √(k m/2) equals ζ √(2 · fastest) times ω.
  const double rate = substeps * kTickHz * kStabilityLimit / std::max(1.0, dampingRatio * std::sqrt(2 * fastest));
  return rate * rate * vertexMass / fastest;
}

Material DrawMaterial(Random& random, double fastest, std::size_t vertices) {
  Material material;
  material.mass = random.DrawMagnitude(1, 20);
  material.dampingRatio = DrawDamping(random);
  material.stiffness =
      DrawStiffness(random, fastest, material.mass / static_cast<double>(vertices), material.dampingRatio);
  material.friction = random.Draw(0, 1.5);
  material.restitution = random.Draw(0, 1);
  if (random.Happens(0.2)) material.contactStiffness = material.stiffness * random.DrawMagnitude(1, 30);
  material.gas = 0;
  return material;
}

std::string DescribeShape(const char* kind, std::size_t vertices, const Material& m) {
  char text[160];
  std::snprintf(text, sizeof text, "%s of %zu, %.3g kg, k %.3g N/m, damping %.2g, gas %.3g J", kind, vertices, m.mass,
                m.stiffness, m.dampingRatio, m.gas);
  return text;
}

struct Draft {
  scenes::BlueprintDefinition definition;
  std::string description;
};

// Draws nRT between a hundredth and all of what the springs can hold, sometimes with an external pressure.
void DrawGas(Random& random, double most, double volume, Material& material) {
  material.gas = random.DrawMagnitude(0.01, 1) * most;
  if (!random.Happens(0.2)) return;
  material.ambientPressure = random.DrawMagnitude(0.1, 10) * material.gas / volume;
  material.gas += material.ambientPressure * volume;
}

Draft DraftBall(Random& random, std::size_t vertices) {
  BallDefinition ball;
  ball.subdivisions = vertices < 42 ? 0 : vertices < 162 ? 1 : vertices < 600 ? 2 : 3;
  ball.radius = random.Draw(0.25, 0.8);
  const std::size_t count = CountVertices(ball.subdivisions);
  ball.material = DrawMaterial(random, 6, count);
  ball.material.drag = random.Happens(0.2) ? random.Draw(0, 1) : 0;
  const double square = ball.radius * ball.radius;
  DrawGas(random, 10 * ball.material.stiffness * square, 4 * std::numbers::pi / 3 * square * ball.radius,
          ball.material);
  return {ball, DescribeShape("ball", count, ball.material)};
}

Draft DraftLattice(Random& random, std::size_t vertices) {
  LatticeDefinition lattice;
  const bool planar = random.Happens(0.3);
  const double side = planar ? std::sqrt(static_cast<double>(vertices)) : std::cbrt(static_cast<double>(vertices));
  for (int& cells : lattice.cells) {
    cells = std::clamp(static_cast<int>(std::lround(side * random.Draw(0.6, 1.5))) - 1, 1, 30);
  }
  if (planar) lattice.cells[1] = 0;
  lattice.poissonRatio = FindPoissonRatio(lattice.cells);
  const int longest = *std::max_element(lattice.cells.begin(), lattice.cells.end());
  lattice.cellSize = random.Draw(0.5, 1.5) / longest;
  lattice.density = random.DrawMagnitude(10, 100);
  lattice.dampingRatio = DrawDamping(random);
  lattice.friction = random.Draw(0, 1.5);
  lattice.restitution = random.Draw(0, 1);
  const double a = lattice.cellSize;
  const double vertexMass = lattice.density * (planar ? a * a : a * a * a);
  const double k = DrawStiffness(random, planar ? 6 : 12, vertexMass, lattice.dampingRatio);
  lattice.youngModulus = planar ? k * 4 / 3 : 2.5 * k / a;
  char text[160];
  std::snprintf(text, sizeof text, "lattice of %dx%dx%d cells, %.3g kg/m3, E %.3g Pa, damping %.2g", lattice.cells[0],
                lattice.cells[1], lattice.cells[2], lattice.density, lattice.youngModulus, lattice.dampingRatio);
  return {lattice, text};
}

Draft DraftRing(Random& random, std::size_t vertices) {
  RingDefinition ring;
  ring.layers = vertices < 20 ? 1 : random.DrawWhole(1, 4);
  ring.points = std::clamp(static_cast<int>(vertices) / ring.layers, 6, 80);
  ring.radius = random.Draw(0.3, 0.8);
  ring.thickness = ring.radius * random.Draw(0.15, 0.5);
  const auto count = static_cast<std::size_t>(ring.points * ring.layers);
  ring.material = DrawMaterial(random, ring.layers > 1 ? 8 : 4, count);
  const double inner = ring.layers > 1 ? ring.radius - ring.thickness : ring.radius;
  const double most = 0.7 * ring.material.stiffness * 2 * std::numbers::pi * inner * inner * 2 / ring.points *
                      std::numbers::pi * ring.layers / 2;
  DrawGas(random, most, std::numbers::pi * inner * inner, ring.material);
  return {ring, DescribeShape(ring.layers > 1 ? "layered ring" : "ring", count, ring.material)};
}

Draft DraftCloth(Random& random, std::size_t vertices) {
  ClothDefinition cloth;
  const double side = std::sqrt(static_cast<double>(vertices));
  for (int& points : cloth.points) {
    points = std::clamp(static_cast<int>(std::lround(side * random.Draw(0.7, 1.4))), 2, 30);
  }
  cloth.spacing = random.Draw(0.8, 2) / (std::max(cloth.points[0], cloth.points[1]) - 1);
  cloth.orientation = random.Happens(0.5) ? Orientation::kHorizontal : Orientation::kVertical;
  constexpr std::array kPins{Pinned::kNone, Pinned::kCorners, Pinned::kTopCorners, Pinned::kEdge, Pinned::kFrame};
  cloth.pinned = kPins[random.Choose(kPins.size())];
  cloth.shear = random.Draw(0.1, 1);
  cloth.bend = random.Draw(0, 0.5);
  cloth.tearStretch = random.Happens(0.15) ? random.Draw(1.1, 3) : 0;
  const auto count = static_cast<std::size_t>(cloth.points[0] * cloth.points[1]);
  cloth.material = DrawMaterial(random, 8, count);
  cloth.material.drag = random.Happens(0.7) ? random.Draw(0, 1) : 0;
  return {cloth, DescribeShape("cloth", count, cloth.material)};
}

Draft DraftPair(Random& random) {
  PairDefinition pair;
  pair.length = random.Draw(0.1, 1);
  pair.direction = random.DrawDirection();
  pair.firstIsFixed = random.Happens(0.3);
  pair.material = DrawMaterial(random, 2, 2);
  return {pair, DescribeShape("pair", 2, pair.material)};
}

// A chain, a strip of two cross-linked rows, or a tower of four rows.
Draft DraftGraph(Random& random, std::size_t vertices) {
  GraphDefinition graph;
  constexpr std::array kRows{1, 2, 4};
  const int rows = kRows[random.Choose(kRows.size())];
  const int count = std::clamp(static_cast<int>(vertices) / rows, 2, 40);
  const double step = random.Draw(0.1, 0.4);
  const double mass = random.DrawMagnitude(0.05, 1);
  const double ratio = DrawDamping(random);
  const double k = DrawStiffness(random, 2 + 2 * rows, mass, ratio);
  graph.planar = rows < 4 && random.Happens(0.5);
  graph.friction = random.Draw(0, 1.5);
  graph.restitution = random.Draw(0, 1);
  graph.contactStiffness = k * random.DrawMagnitude(1, 10);
  for (int i = 0; i < count; ++i) {
    for (int row = 0; row < rows; ++row) {
      const Vector3d place(i * step, row / 2 * step, row % 2 * step);
      graph.particles.push_back({place, mass * random.Draw(0.5, 1.5), i == 0 && random.Happens(0.15)});
      const int end = rows * i + row;
      const auto join = [&](int other) {
        const double own = k * random.Draw(0.5, 1);
        graph.springs.push_back({other, end, own, ratio * 2 * std::sqrt(own * mass / 2), 0});
      };
      for (int other = rows * i; other < end; ++other) join(other);
      for (int other = 0; i > 0 && other < rows; ++other) join(rows * (i - 1) + other);
    }
  }
  char text[160];
  std::snprintf(text, sizeof text, "graph of %zu, %d a row, %.3g kg each, k %.3g N/m, damping %.2g",
                graph.particles.size(), rows, mass, k, ratio);
  return {graph, text};
}

// A box, or a flattened or elongated ball of tetrahedra. Of all modes of a cell of size a the fastest has ω a/c of
// about kFastest, c² = E (1 − ν)/ρ(1 + ν)(1 − 2ν); in a filled surface, where cells are cut, more.
Draft DraftSolid(Random& random, std::size_t vertices) {
  constexpr double kFastest = 4;
  constexpr double kFastestCut = 9;
  SolidDefinition solid;
  const bool isBox = random.Happens(0.6);
  const double side = std::cbrt(static_cast<double>(vertices) / 2);
  for (int& cells : solid.cells) {
    cells = std::clamp(static_cast<int>(std::lround(side * random.Draw(0.6, 1.5))) - 1, 1, 12);
  }
  const double longest = *std::max_element(solid.cells.begin(), solid.cells.end());
  solid.cellSize = random.Draw(0.5, 1.5) / longest;
  if (!isBox) {
    const Icosphere sphere = MakeIcosphere(2);
    const Vector3d axes = random.DrawWithin({0.3, 0.3, 0.3}, {0.6, 0.6, 0.6});
    for (const Vector3d& at : sphere.vertices) solid.vertices.push_back(at.cwiseProduct(axes));
    solid.faces = sphere.faces;
    solid.cellSize = 2 * axes.mean() / std::clamp(side, 2.5, 7.0);
  }
  solid.poissonRatio = random.Draw(0, kMaxPoissonRatio);
  solid.density = random.DrawMagnitude(10, 100);
  solid.dampingRatio = DrawDamping(random);
  solid.friction = random.Draw(0, 1.5);
  solid.restitution = random.Draw(0, 1);
  const double nu = solid.poissonRatio;
  const double waves = (1 - nu) / (1 + nu) / (1 - 2 * nu);  // c² over E/ρ
  const double fastest = isBox ? kFastest : kFastestCut;
  const double a = solid.cellSize;
  solid.youngModulus =
      DrawStiffness(random, fastest * fastest * waves, solid.density * a * a * a, solid.dampingRatio) / a;
  char text[160];
  std::snprintf(text, sizeof text, "solid %s of %.3g m cells, nu %.2f, %.3g kg/m3, E %.3g Pa, damping %.2g",
                isBox ? "box" : "ball", a, nu, solid.density, solid.youngModulus, solid.dampingRatio);
  return {solid, text};
}

// A flattened or elongated icosphere with gas, or half of one, which is open.
Draft DraftMesh(Random& random, std::size_t vertices) {
  MeshDefinition mesh;
  const Icosphere sphere = MakeIcosphere(vertices < 42 ? 0 : vertices < 162 ? 1 : 2);
  const bool open = random.Happens(0.4);
  const Vector3d axes = random.DrawWithin({0.25, 0.25, 0.25}, {0.6, 0.6, 0.6});
  std::vector<int> places(sphere.vertices.size(), -1);
  for (const Face& face : sphere.faces) {
    const double height = sphere.vertices[face[0]].z() + sphere.vertices[face[1]].z() + sphere.vertices[face[2]].z();
    if (open && height < 0) continue;
    Face kept = face;
    for (std::uint16_t& corner : kept) {
      if (places[corner] < 0) {
        places[corner] = static_cast<int>(mesh.vertices.size());
        mesh.vertices.push_back(sphere.vertices[corner].cwiseProduct(axes));
      }
      corner = static_cast<std::uint16_t>(places[corner]);
    }
    mesh.faces.push_back(kept);
  }
  mesh.bend = random.Draw(0.1, 0.6);
  mesh.material = DrawMaterial(random, 9, mesh.vertices.size());
  mesh.material.drag = random.Happens(0.3) ? random.Draw(0, 1) : 0;
  const double extent = std::cbrt(axes.prod());
  if (!open) {
    const double most = 3 * mesh.material.stiffness * extent * extent;
    DrawGas(random, most, 4 * std::numbers::pi / 3 * axes.prod(), mesh.material);
  }
  return {mesh, DescribeShape(open ? "open mesh" : "closed mesh", mesh.vertices.size(), mesh.material)};
}

Draft DraftAny(Random& random, std::size_t vertices) {
  const std::size_t lot = random.Choose(22);
  if (lot < 7) return DraftBall(random, vertices);
  if (lot < 11) return DraftLattice(random, vertices);
  if (lot < 13) return DraftRing(random, vertices);
  if (lot < 15) return DraftCloth(random, vertices);
  if (lot < 17) return DraftMesh(random, vertices);
  if (lot < 19) return DraftGraph(random, vertices);
  return lot < 20 ? DraftPair(random) : DraftSolid(random, vertices);
}

}  // namespace

RandomBody DrawBody(Random& random, std::size_t vertices) {
  RandomBody body;
  for (;;) {
    const Draft draft = DraftAny(random, vertices);
    if (!scenes::Validate(draft.definition).empty()) {
      ++body.refused;
      continue;
    }
    body.blueprint = scenes::MakeBlueprint(draft.definition);
    body.definition = draft.definition;
    body.description = draft.description;
    return body;
  }
}

}  // namespace wobble::bench
