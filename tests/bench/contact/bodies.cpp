#include "tests/bench/contact/bodies.h"

#include <array>
#include <cmath>

#include "server/physics/contact/contact.h"
#include "server/physics/shapes/finish_blueprint.h"

namespace wobble::bench {

using namespace physics;

Blueprint MakeParticles(double restitution) {
  constexpr double kMass = 0.05;  // per particle, kg
  Blueprint blueprint;
  blueprint.name = "particles";
  blueprint.rest = {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(-1, 0, 0), Vector3d(0, -1, 0)};
  blueprint.full.masses.assign(blueprint.rest.size(), kMass);
  Material material;
  material.restitution = restitution;
  blueprint.full.contact = MakeContactParameters(material, kMass, DescribeBall(2).radius);
  FinishBlueprint(blueprint);
  return blueprint;
}

BallDefinition DescribeBall(int subdivisions) {
  BallDefinition ball;
  ball.subdivisions = subdivisions;
  return ball;
}

BallDefinition DescribeHardBall(int subdivisions, double ratio) {
  BallDefinition ball = DescribeBall(subdivisions);
  ball.material.stiffness *= ratio;
  ball.material.gas *= ratio;
  return ball;
}

LatticeDefinition DescribeCube(double youngModulus, double friction) {
  LatticeDefinition cube;
  cube.youngModulus = youngModulus;
  cube.friction = friction;
  return cube;
}

Blueprint MakeSheet(int cells, double cellSize, double mass, double stiffness) {
  const int side = cells + 1;
  const auto at = [side](int x, int y) { return static_cast<std::uint16_t>(y * side + x); };
  Blueprint blueprint;
  blueprint.name = "sheet";
  Coefficients<double>& full = blueprint.full;
  constexpr double kRim = 1000;
  const double vertexMass = mass / (side * side);
  const double damping = 0.2 * 2 * std::sqrt(stiffness * vertexMass / 2);
  for (int y = 0; y < side; ++y) {
    for (int x = 0; x < side; ++x) {
      blueprint.rest.push_back(cellSize * Vector3d(x, y, 0));
      const bool onRim = x == 0 || y == 0 || x + 1 == side || y + 1 == side;
      full.masses.push_back(onRim ? kRim * vertexMass : vertexMass);
      const auto join = [&](int toX, int toY, double length) {
        if (toX < 0 || toX >= side || toY >= side) return;
        full.springs.push_back({at(x, y), at(toX, toY), length * cellSize, stiffness, damping});
      };
      join(x + 1, y, 1);
      join(x, y + 1, 1);
      join(x + 1, y + 1, std::sqrt(2.0));
      join(x - 1, y + 1, std::sqrt(2.0));
      if (x + 1 == side || y + 1 == side) continue;
      full.faces.push_back({at(x, y), at(x + 1, y), at(x + 1, y + 1)});
      full.faces.push_back({at(x, y), at(x + 1, y + 1), at(x, y + 1)});
    }
  }
  Material material;
  material.stiffness = stiffness;
  full.contact = MakeContactParameters(material, vertexMass, DescribeBall(2).radius);
  FinishBlueprint(blueprint);
  // Each vertex stands for the same area, whatever its mass.
  full.contactShares.assign(full.contactShares.size(), 1);
  blueprint.single.contactShares.assign(full.contactShares.size(), 1);
  return blueprint;
}

std::vector<Vector3d> ReadPositions(const Body& body) {
  std::vector<Vector3d> positions;
  VisitVertices(body, [&](std::size_t, const Vector3d& p) { positions.push_back(p); });
  return positions;
}

std::vector<Vector3d> ReadVelocities(const Body& body) {
  std::vector<Vector3d> velocities;
  std::visit(
      [&](const auto& state) {
        for (const auto& v : state.velocities) velocities.push_back(v.template cast<double>());
      },
      body.state);
  return velocities;
}

void KeepAwake(World& world) {
  const std::array<VertexForce<double>, 1> nothing{{{.vertex = 0, .force = Vector3d::Zero()}}};
  for (const Body& body : world.Bodies()) world.PushVertices(body.id, nothing);
}

Vector3d FindVelocity(const World& world, const Body& body) {
  return std::visit([&](const auto& state) { return FindMeanVelocity(world.BlueprintOf(body), state); }, body.state);
}

}  // namespace wobble::bench
