// The bodies of the stress part, as scenes have them by default: of every kind but `mesh` and planar lattices.
#pragma once

#include <cstddef>
#include <cstdint>

#include "server/physics/world.h"
#include "tests/bench/random.h"

namespace wobble::bench {

enum class StressBody : std::uint8_t { kBall162, kBall42, kLattice, kSolid, kCloth, kRing, kPair, kGraph };
inline constexpr StressBody kAllStressBodies[] = {StressBody::kBall162, StressBody::kBall42, StressBody::kLattice,
                                                  StressBody::kSolid,   StressBody::kCloth,  StressBody::kRing,
                                                  StressBody::kPair,    StressBody::kGraph};
[[nodiscard]] const char* NameStressBody(StressBody kind);

// factor: on mass, stiffness and gas alike, so that the body moves as the default one does.
[[nodiscard]] physics::Blueprint MakeStressBody(StressBody kind, double factor = 1);

// Adds four walls round the z axis, at `half` from it, m. Planar bodies stay in their plane without any.
void AddShaft(double half, physics::World& world);

// What became of the bodies of one trial.
struct StressOutcome {
  std::uint32_t nonFinite = 0;    // body-ticks
  std::uint32_t quarantined = 0;  // body-ticks
  std::uint32_t reset = 0;
  std::uint32_t inverted = 0;  // bodies other than lattices, two seconds after the load has gone
  std::uint32_t folded = 0;    // lattices with a cell inside out then
  std::uint32_t through = 0;   // bodies that end where something should have held them
  double substeps = 0;         // the most that a tick took, a body
};

// Steps the world and notes what failed.
void PlayStress(physics::World& world, double duration, StressOutcome& outcome);

// Adds the bodies of which any part is inside out: the gas, a tetrahedron, a cell of a lattice.
void NoteInverted(const physics::World& world, StressOutcome& outcome);

}  // namespace wobble::bench
