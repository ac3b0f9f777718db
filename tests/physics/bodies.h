// Small bodies that physics tests share.
#pragma once

#include <cmath>
#include <vector>

#include "server/physics/methods/forces.h"
#include "server/physics/shapes/ball.h"
#include "server/physics/shapes/lattice.h"
#include "server/physics/shapes/mesh.h"
#include "server/physics/shapes/solid.h"
#include "server/physics/world.h"

namespace wobble::physics {

// The ball that the project's documents measure: 162 vertices of 0.25 kg, springs of 750 N/m, radius 1 m.
inline BallDefinition MakeMeasuredBall(double dampingRatio = 0) {
  BallDefinition ball;
  ball.radius = 1;
  ball.material.mass = 0.25 * 162;
  ball.material.stiffness = 750;
  ball.material.gas = 1000;
  ball.material.dampingRatio = dampingRatio;
  return ball;
}

// A cube of jelly of 0.75 m, 64 vertices.
inline LatticeDefinition MakeJellyCube(double dampingRatio = 0) {
  LatticeDefinition cube;
  cube.dampingRatio = dampingRatio;
  return cube;
}

// A solid box of cells of 0.25 m.
inline SolidDefinition MakeSolidBox(const std::array<int, 3>& cells, double poissonRatio, double dampingRatio = 0.1) {
  SolidDefinition box;
  box.cells = cells;
  box.poissonRatio = poissonRatio;
  box.dampingRatio = dampingRatio;
  return box;
}

// A closed shell of 42 vertices with gas, three times as long as it is thick.
inline Blueprint MakeOblong() {
  const Icosphere sphere = MakeIcosphere(1);
  MeshDefinition oblong;
  oblong.name = "oblong";
  oblong.faces = sphere.faces;
  for (const Vector3d& at : sphere.vertices) oblong.vertices.push_back(at.cwiseProduct(Vector3d(0.6, 0.4, 0.2)));
  oblong.material.mass = 4;
  oblong.material.stiffness = 600;
  oblong.material.gas = 80;
  return MakeMesh(oblong);
}

// The vertices of a body in the world, m.
inline std::vector<Vector3d> ListPositions(const World& world, BodyId id) {
  std::vector<Vector3d> positions;
  VisitVertices(world.ReadBody(id), [&](std::size_t, const Vector3d& x) { positions.push_back(x); });
  return positions;
}

// Positions moved by a smooth, repeatable pattern of `amplitude` metres.
inline std::vector<Vector3d> Deform(std::vector<Vector3d> x, double amplitude) {
  for (std::size_t i = 0; i < x.size(); ++i) {
    const auto phase = static_cast<double>(i);
    x[i] += amplitude * Vector3d(std::sin(1.3 * phase), std::cos(2.1 * phase), std::sin(0.7 * phase + 1));
  }
  return x;
}

}  // namespace wobble::physics
