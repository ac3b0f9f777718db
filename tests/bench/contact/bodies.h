// Bodies that the contact experiments share, and functions that read their state.
#pragma once

#include <vector>

#include "server/physics/shapes/ball.h"
#include "server/physics/shapes/lattice.h"
#include "server/physics/world.h"

namespace wobble::bench {

using physics::Vector3d;

// Gravity and tick of the contact experiments, the same as in the scenes.
inline constexpr double kContactGravity = 9.81;   // m/s²
inline constexpr double kContactTick = 1.0 / 60;  // s

// Four unconnected masses in a horizontal square: each moves as a separate particle, and all move alike.
[[nodiscard]] physics::Blueprint MakeParticles(double restitution);

// The ball of the scenes: radius 0.5 m, 8 kg.
[[nodiscard]] physics::BallDefinition DescribeBall(int subdivisions);
// A ball with `ratio` times the stiffness and gas of the default ball; it bears impacts of `ratio` times the energy.
[[nodiscard]] physics::BallDefinition DescribeHardBall(int subdivisions, double ratio);
// A cube of 0.75 m with 64 vertices.
[[nodiscard]] physics::LatticeDefinition DescribeCube(double youngModulus, double friction);
// A flat square sheet of springs in the plane z = 0, open and without gas: a cloth as far as contact is concerned. Its
// rim is so heavy that it hardly moves, as if held in a frame. mass: of the vertices inside the rim, kg.
[[nodiscard]] physics::Blueprint MakeSheet(int cells, double cellSize, double mass, double stiffness);

[[nodiscard]] std::vector<Vector3d> ReadPositions(const physics::Body& body);   // in the world, m
[[nodiscard]] std::vector<Vector3d> ReadVelocities(const physics::Body& body);  // m/s
// Wakes every body and changes nothing else: a push without force. World::SetMotion, which wakes as well, makes the
// next step look whether a body has lost its shape, which the others look at every eighth tick: a cube that was folded
// for a tick by its fall began to unfold in the twin alone, and was counted as off by 1.7 mm.
void KeepAwake(physics::World& world);
// Velocity of the centre of mass, m/s.
[[nodiscard]] Vector3d FindVelocity(const physics::World& world, const physics::Body& body);

}  // namespace wobble::bench
