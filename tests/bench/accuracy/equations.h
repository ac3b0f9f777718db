// The equations of motion written a second time, plainly and in other words than the engine's, straight from its
// description: what the engine is compared with must not share its mistakes. Only a blueprint's numbers are shared.
#pragma once

#include <span>
#include <vector>

#include "server/physics/contact/obstacle.h"
#include "server/physics/methods/forces.h"
#include "server/physics/model/blueprint.h"

namespace wobble::bench {

using physics::Vector3d;

// One body on its own. Vertices are in the world, in double precision.
struct Equations {
  const physics::Blueprint* blueprint = nullptr;
  Vector3d gravity = Vector3d::Zero();  // m/s²
  Vector3d wind = Vector3d::Zero();     // m/s
  std::vector<physics::VertexForce<double>> pulls;
  std::vector<physics::Obstacle> obstacles;  // planes, met by the penalty law without friction

  [[nodiscard]] std::size_t CountVertices() const { return blueprint->rest.size(); }
};

// What the body's own springs, gas, neighbours and medium do, N, added to `forces`.
void AddOwnForces(const Equations& equations, std::span<const Vector3d> x, std::span<const Vector3d> v,
                  std::span<Vector3d> forces);
// Gravity and all other forces, over the masses, m/s². Fixed vertices and what is across a plane have none.
void FindAccelerations(const Equations& equations, std::span<const Vector3d> x, std::span<const Vector3d> v,
                       std::span<Vector3d> accelerations);

// Kinetic, of springs, repulsion, gas, height and the ground, J; up to a constant.
[[nodiscard]] double FindEnergy(const Equations& equations, std::span<const Vector3d> x, std::span<const Vector3d> v);

}  // namespace wobble::bench
