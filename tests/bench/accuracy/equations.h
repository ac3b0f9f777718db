// A second, independent implementation of the equations of motion, written plainly from the engine's description. The
// engine is compared with it, so the two must not share a mistake: only the numbers of a blueprint are shared.
#pragma once

#include <span>
#include <vector>

#include "server/physics/contact/obstacle.h"
#include "server/physics/methods/forces.h"
#include "server/physics/model/blueprint.h"

namespace wobble::bench {

using physics::Vector3d;

// A single body and what acts on it. Vertices are in world coordinates, in double precision.
struct Equations {
  const physics::Blueprint* blueprint = nullptr;
  Vector3d gravity = Vector3d::Zero();  // m/s²
  Vector3d wind = Vector3d::Zero();     // m/s
  std::vector<physics::VertexForce<double>> pulls;
  std::vector<physics::Obstacle> obstacles;  // planes only; penalty law without friction

  [[nodiscard]] std::size_t CountVertices() const { return blueprint->rest.size(); }
};

// Adds to `forces` the forces of springs, gas, self-repulsion and the medium, N. All spans have one entry per vertex.
void AddOwnForces(const Equations& equations, std::span<const Vector3d> x, std::span<const Vector3d> v,
                  std::span<Vector3d> forces);
// Writes the acceleration of every vertex under all forces, gravity and obstacles included, m/s². It is zero for fixed
// vertices and in directions that a plane blocks.
void FindAccelerations(const Equations& equations, std::span<const Vector3d> x, std::span<const Vector3d> v,
                       std::span<Vector3d> accelerations);

// Total energy: kinetic, springs, repulsion, gas, height and ground contact, J; defined up to a constant.
[[nodiscard]] double FindEnergy(const Equations& equations, std::span<const Vector3d> x, std::span<const Vector3d> v);

}  // namespace wobble::bench
