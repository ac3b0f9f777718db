// Graphs: particles and springs as somebody lists them, and the blueprints that follow when he changes his mind while
// the world runs. A blueprint is immutable, so every change makes another one.
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
  // Of those that were there and still are, which come first and in their order: their places before. The former is
  // what World::ReplaceBlueprint asks for.
  std::vector<std::uint16_t> keptParticles;
  std::vector<std::uint16_t> keptSprings;
};

// Of a blueprint that MakeGraph or one of these has made. Particles and springs keep their order and new ones come
// last, so a body's state goes on as it is, with a new particle's position and velocity at its end. Positions are in
// the rest shape of `graph`, about its centre of mass; the new blueprint's rest shape has a centre of its own.
//
// Of a body that moves, the rest shape says nothing of where its particles are now. So whoever builds on it as it is
// seen takes that for the rest shape first: SetShape with the body's positions, and AddParticle with the place in the
// world less the body's centre there, or both in one by the AddParticle that takes positions. Then ReplaceBlueprint
// puts the particle where it was asked for, at rest, and leaves the others as they are; SetMotion may give it a
// velocity. A rest length of 0 is then what lies between a spring's ends as they are.
[[nodiscard]] GraphEdit AddParticle(const Blueprint& graph, const Particle& particle);
// particle.position as well as these positions, one a particle, are in the world.
[[nodiscard]] GraphEdit AddParticle(const Blueprint& graph, std::span<const Vector3d> positions,
                                    const Particle& particle);
[[nodiscard]] GraphEdit AddSpring(const Blueprint& graph, const GraphSpring& spring);
// Its ends stay; `spring` gives the rest.
[[nodiscard]] GraphEdit SetSpring(const Blueprint& graph, std::size_t index, const GraphSpring& spring);
[[nodiscard]] GraphEdit SetMass(const Blueprint& graph, std::size_t particle, double mass);
[[nodiscard]] GraphEdit SetFixed(const Blueprint& graph, std::size_t particle, bool fixed);
// The shape that particles at these positions, one each, wherever in the world, are in. Springs stay as they are.
[[nodiscard]] GraphEdit SetShape(const Blueprint& graph, std::span<const Vector3d> positions);
// With the springs that end in it. One particle at least must stay.
[[nodiscard]] GraphEdit RemoveParticle(const Blueprint& graph, std::size_t index);
[[nodiscard]] GraphEdit RemoveSpring(const Blueprint& graph, std::size_t index);

}  // namespace wobble::physics
