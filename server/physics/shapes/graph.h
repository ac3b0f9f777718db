// Graphs: bodies from a list of particles and springs, and the changes of such a body while the world runs. A blueprint
// is immutable, so every change makes another one.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "server/physics/model/blueprint.h"

namespace wobble::physics {

struct Particle {
  Vector3d position = Vector3d::Zero();  // m
  double mass = 1;                       // kg
  bool fixed = false;
};

// Between particles `a` and `b`, by their places in the list.
struct GraphSpring {
  int a = 0;
  int b = 1;
  double stiffness = 100;  // N/m
  double damping = 1;      // N·s/m
  double restLength = 0;   // m; 0: the distance of its ends
};

struct GraphDefinition {
  std::string name = "graph";
  std::vector<Particle> particles;
  std::vector<GraphSpring> springs;
  bool planar = false;              // in the plane y = 0
  double friction = 0.8;            // Coulomb's coefficient, static and kinetic
  double rollingResistance = 0.03;  // moment on a body that rolls, over normal force and size
  double restitution = 0.5;         // of a particle on a rigid surface
  double contactStiffness = 1000;   // of a particle against a surface, N/m
  double radius = 0.03;             // of its particles and springs, which meet other bodies as balls and capsules, m
};

inline constexpr std::size_t kMaxParticles = 512;
inline constexpr std::size_t kMaxGraphSprings = 4096;

// Lists every bad field of a definition; the fields of the i-th particle are named "particle[i].mass" and so on.
[[nodiscard]] std::vector<FieldError> ValidateGraph(const GraphDefinition& definition);

// The definition must be valid. The rest shape is the listed one, whether or not its springs are at rest in it.
[[nodiscard]] Blueprint MakeGraph(const GraphDefinition& definition);

// A changed blueprint, or the errors of the change.
struct GraphEdit {
  Blueprint blueprint;  // meaningful only when there are no errors
  std::vector<FieldError> errors;
  // Particles and springs that the change keeps come first and in their order; these are their places before the
  // change. World::ReplaceBlueprint takes keptParticles.
  std::vector<std::uint16_t> keptParticles;
  std::vector<std::uint16_t> keptSprings;
};

// What tells two states of a graph that is changed in play from one another: enough to make one of the other.
struct GraphParts {
  std::vector<Vector3d> rest;  // about the centre of mass, m
  std::vector<double> masses;  // kg
  std::vector<std::uint16_t> fixed;
  std::vector<Spring<double>> springs;
};
[[nodiscard]] GraphParts FindParts(const Blueprint& graph);
// The graph with other parts, to the bit as the changes below have made it; name, plane, radius and contact law stay.
// Any parts are safe: those that no graph has are errors.
[[nodiscard]] GraphEdit SetParts(const Blueprint& graph, const GraphParts& parts);

// The changes. `graph` must come from MakeGraph or one of these functions. Particles and springs keep their order and
// new ones come last, so a body's state stays valid, with a new particle's position and velocity at its end. Positions
// are in the rest shape of `graph`, about its centre of mass; the new blueprint's rest shape has a centre of its own.
// Errors name field, value and range; places that do not exist are errors.
//
// The rest shape of a moving body does not tell where its particles are now. To build on a body as it is seen, make its
// present shape the rest shape first: SetShape with the body's positions, then AddParticle with the place in the world
// less the body's centre there; or both at once by the AddParticle that takes positions. ReplaceBlueprint then puts the
// particle at that place, at rest, and leaves the others as they are; SetMotion may give it a velocity. A rest length
// of 0 is then the present distance of a spring's ends.
[[nodiscard]] GraphEdit AddParticle(const Blueprint& graph, const Particle& particle);
// particle.position and `positions`, one a particle, are in the world.
[[nodiscard]] GraphEdit AddParticle(const Blueprint& graph, std::span<const Vector3d> positions,
                                    const Particle& particle);
[[nodiscard]] GraphEdit AddSpring(const Blueprint& graph, const GraphSpring& spring);
// Keeps the ends of the spring at `index`; takes the other fields from `spring`.
[[nodiscard]] GraphEdit SetSpring(const Blueprint& graph, std::size_t index, const GraphSpring& spring);
[[nodiscard]] GraphEdit SetMass(const Blueprint& graph, std::size_t particle, double mass);
[[nodiscard]] GraphEdit SetFixed(const Blueprint& graph, std::size_t particle, bool fixed);
// Makes the shape of particles at these positions, one each, in any frame, the rest shape. Springs stay as they are.
[[nodiscard]] GraphEdit SetShape(const Blueprint& graph, std::span<const Vector3d> positions);
// Removes the springs that end in the particle as well. At least one particle must stay.
[[nodiscard]] GraphEdit RemoveParticle(const Blueprint& graph, std::size_t index);
[[nodiscard]] GraphEdit RemoveSpring(const Blueprint& graph, std::size_t index);

}  // namespace wobble::physics
