#include "tests/bench/stress/bodies.h"

#include <algorithm>
#include <cmath>

#include "server/physics/methods/forces.h"
#include "server/physics/shapes/ball.h"
#include "server/physics/shapes/cloth.h"
#include "server/physics/shapes/graph.h"
#include "server/physics/shapes/lattice.h"
#include "server/physics/shapes/pair.h"
#include "server/physics/shapes/ring.h"
#include "server/physics/shapes/solid.h"
#include "tests/bench/contact/bodies.h"

namespace wobble::bench {
namespace {

using namespace physics;

template <class Definition>
Definition Scale(Definition definition, double factor) {
  definition.material.mass *= factor;
  definition.material.stiffness *= factor;
  definition.material.gas *= factor;
  return definition;
}

template <class Definition>
Definition ScaleElastic(Definition definition, double factor) {
  definition.density *= factor;
  definition.youngModulus *= factor;
  return definition;
}

// A tetrahedron with a tail.
GraphDefinition DescribeTail(double factor) {
  GraphDefinition graph;
  for (const Vector3d& at : {Vector3d(0, 0, 0), Vector3d(0.5, 0, 0), Vector3d(0.25, 0.45, 0), Vector3d(0.25, 0.15, 0.4),
                             Vector3d(0.25, 0.15, 0.8), Vector3d(0.25, 0.15, 1.2)}) {
    graph.particles.push_back({.position = at, .mass = 0.3 * factor});
  }
  const auto join = [&](int a, int b) {
    graph.springs.push_back({.a = a, .b = b, .stiffness = 400 * factor, .damping = 1 * factor});
  };
  for (int a = 0; a < 4; ++a) {
    for (int b = 0; b < a; ++b) join(b, a);
  }
  join(3, 4);
  join(4, 5);
  graph.contactStiffness *= factor;
  return graph;
}

// The volume that the mean edges of a cell span, over all cells of a lattice in space.
bool HasInvertedCell(const GridShape& grid, const std::vector<Vector3d>& x) {
  const std::size_t columns = grid.columns;
  const std::size_t layer = columns * grid.rows;
  for (std::size_t k = 0; k + 1 < grid.layers; ++k) {
    for (std::size_t j = 0; j + 1 < grid.rows; ++j) {
      for (std::size_t i = 0; i + 1 < columns; ++i) {
        const std::size_t first = k * layer + j * columns + i;
        Vector3d edges[3] = {Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
        for (std::size_t corner = 0; corner < 8; ++corner) {
          const Vector3d& at = x[first + (corner & 1U) + (corner >> 1U & 1U) * columns + (corner >> 2U) * layer];
          for (std::size_t axis = 0; axis < 3; ++axis) edges[axis] += (corner >> axis & 1U) != 0 ? at : Vector3d(-at);
        }
        if (!(edges[0].dot(edges[1].cross(edges[2])) > 0)) return true;
      }
    }
  }
  return false;
}

bool HasInvertedElement(const Blueprint& blueprint, const std::vector<Vector3d>& x) {
  return std::ranges::any_of(blueprint.full.tetrahedra, [&](const Tetrahedron<double>& element) {
    const auto& [a, b, c, d] = element.vertices;
    return !((x[b] - x[a]).dot((x[c] - x[a]).cross(x[d] - x[a])) > 0);
  });
}

}  // namespace

const char* NameStressBody(StressBody kind) {
  constexpr const char* kNames[] = {"ball of 162", "ball of 42", "lattice", "solid", "cloth", "ring", "pair", "graph"};
  return kNames[static_cast<std::size_t>(kind)];
}

Blueprint MakeStressBody(StressBody kind, double factor) {
  BallDefinition ball;
  ClothDefinition cloth{.points = {10, 10}, .orientation = Orientation::kHorizontal};
  switch (kind) {
    case StressBody::kBall162:
      ball.subdivisions = 2;
      return MakeBall(Scale(ball, factor));
    case StressBody::kBall42:
      ball.subdivisions = 1;
      return MakeBall(Scale(ball, factor));
    case StressBody::kLattice:
      return MakeLattice(ScaleElastic(LatticeDefinition{}, factor));
    case StressBody::kSolid:
      return MakeSolid(ScaleElastic(SolidDefinition{}, factor));
    case StressBody::kCloth:
      return MakeCloth(Scale(cloth, factor));
    case StressBody::kRing:
      return MakeRing(Scale(RingDefinition{}, factor));
    case StressBody::kPair:
      return MakePair(Scale(PairDefinition{}, factor));
    case StressBody::kGraph:
      break;
  }
  return MakeGraph(DescribeTail(factor));
}

void AddShaft(double half, World& world) {
  for (const double side : {-1.0, 1.0}) {
    for (int axis = 0; axis < 2; ++axis) {
      Obstacle wall;
      wall.normal = Vector3d::Zero();
      wall.normal[axis] = side;
      wall.offset = -half;
      wall.friction = 0.3;
      world.AddObstacle(wall);
    }
  }
}

void PlayStress(World& world, double duration, StressOutcome& outcome) {
  const int ticks = static_cast<int>(std::lround(duration / world.Settings().tickDuration));
  for (int tick = 0; tick < ticks; ++tick) {
    const StepReport report = world.Step();
    outcome.nonFinite += report.nonFinite;
    outcome.quarantined += report.quarantined;
    outcome.reset += report.reset;
    if (report.awake == 0) continue;
    outcome.substeps = std::max(outcome.substeps, static_cast<double>(report.substeps) / report.awake);
  }
}

void NoteInverted(const World& world, StressOutcome& outcome) {
  for (const Body& body : world.Bodies()) {
    const Blueprint& blueprint = world.BlueprintOf(body);
    const std::vector<Vector3d> x = ReadPositions(body);
    outcome.inverted += IsInsideOut<double>(blueprint.full, x) || HasInvertedElement(blueprint, x) ? 1 : 0;
    outcome.folded += blueprint.grid.layers > 1 && HasInvertedCell(blueprint.grid, x) ? 1 : 0;
  }
}

}  // namespace wobble::bench
