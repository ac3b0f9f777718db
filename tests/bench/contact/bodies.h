// Bodies that the contact experiments share, and what they read off them.
#pragma once

#include <vector>

#include "server/physics/shapes/ball.h"
#include "server/physics/shapes/lattice.h"
#include "server/physics/world.h"

namespace wobble::bench {

using physics::Vector3d;

// Four masses in a horizontal square that nothing joins: each is a particle of its own, and all do the same.
[[nodiscard]] physics::Blueprint MakeParticles(double restitution);

// As the scenes have it: 0.5 m, 8 kg.
[[nodiscard]] physics::BallDefinition DescribeBall(int subdivisions);
// Springs and gas `ratio` times those of the default ball, which then takes impacts of so much more energy.
[[nodiscard]] physics::BallDefinition DescribeHardBall(int subdivisions, double ratio);
// A cube of 0.75 m with 64 vertices.
[[nodiscard]] physics::LatticeDefinition DescribeCube(double youngModulus, double friction);
// A flat square sheet of springs in the plane of z, open, without gas: what a cloth is to a contact. Its rim is so
// heavy that it hardly moves, as if held in a frame. mass: of what is within, kg.
[[nodiscard]] physics::Blueprint MakeSheet(int cells, double cellSize, double mass, double stiffness);

[[nodiscard]] std::vector<Vector3d> ReadPositions(const physics::Body& body);   // in the world, m
[[nodiscard]] std::vector<Vector3d> ReadVelocities(const physics::Body& body);  // m/s
// Of the centre of mass.
[[nodiscard]] Vector3d FindVelocity(const physics::World& world, const physics::Body& body);

}  // namespace wobble::bench
