// Graphs: particles and springs as somebody lists them, and the blueprints that follow when he changes his mind while
// the world runs. A blueprint is immutable, so every change makes another one.
#pragma once

#include <string>
#include <vector>

#include "server/physics/blueprint.h"

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
  double restLength = 0;   // m; 0: as far as its ends are apart
};

struct GraphDefinition {
  std::string name = "graph";
  std::vector<Particle> particles;
  std::vector<GraphSpring> springs;
  bool planar = false;             // in the plane y = 0
  double friction = 0.8;           // Coulomb's coefficient, static and kinetic
  double restitution = 0.5;        // of a particle on a rigid surface
  double contactStiffness = 1000;  // of a particle against a surface, N/m
};

inline constexpr std::size_t kMaxParticles = 512;
inline constexpr std::size_t kMaxGraphSprings = 4096;

// Everything that is wrong; the fields of the i-th particle are named "particle[i].mass" and so on.
[[nodiscard]] std::vector<FieldError> ValidateGraph(const GraphDefinition& definition);

// The definition must be valid. The rest shape is the one that is listed, whether its springs are at rest in it or not.
[[nodiscard]] Blueprint MakeGraph(const GraphDefinition& definition);

// A changed blueprint, or what is wrong with the change.
struct GraphEdit {
  Blueprint blueprint;  // meaningful only when there are no errors
  std::vector<FieldError> errors;
};

// Of a blueprint that MakeGraph or one of these has made. Particles and springs keep their places in the lists and new
// ones come last, so a body's state goes on as it is, with a new particle's position and velocity at its end. Positions
// are in the rest shape of `graph`, about its centre of mass; the new blueprint's rest shape has a centre of its own.
[[nodiscard]] GraphEdit AddParticle(const Blueprint& graph, const Particle& particle);
[[nodiscard]] GraphEdit AddSpring(const Blueprint& graph, const GraphSpring& spring);
// Its ends stay; `spring` gives the rest.
[[nodiscard]] GraphEdit SetSpring(const Blueprint& graph, std::size_t index, const GraphSpring& spring);
[[nodiscard]] GraphEdit SetMass(const Blueprint& graph, std::size_t particle, double mass);

}  // namespace wobble::physics
