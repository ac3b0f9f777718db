// The changing data of one body: positions and velocities of its vertices, contacts with obstacles, torn springs.
//
// Positions are local: the position in the world is origin + x, with the origin in double precision. A float then
// resolves a body of a metre to 10⁻⁷ m wherever in the world it is; world coordinates would lose three digits at 100 m
// and let an oscillator far out gain energy. The origin follows the body in steps of a whole power of two.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/physics/model/blueprint.h"
#include "server/physics/model/vector.h"

namespace wobble::physics {

// A vertex near a static surface (the laws: contact/contact.h). Lists are sorted by surface, then vertex; anchors live
// on from tick to tick.
template <class Real>
struct Contact {
  std::uint32_t surface = 0;
  std::uint32_t vertex = 0;
  bool touching = false;                         // at the end of the last substep; the anchor is then set
  bool buried = false;                           // in ground that the vertex entered over its border: no force
  Vector3<Real> anchor = Vector3<Real>::Zero();  // end of the stick spring on the surface, local coordinates, m
  Vector3<Real> slip = Vector3<Real>::Zero();    // backtracking: velocity along the surface after the last substep, m/s
  Vector3<Real> side = Vector3<Real>::Zero();    // normal of the surface where the vertex was last; zero: not yet known
};

template <class Real>
struct State {
  Vector3d origin = Vector3d::Zero();     // m
  std::vector<Vector3<Real>> positions;   // local, m
  std::vector<Vector3<Real>> velocities;  // m/s
  std::vector<Contact<Real>> contacts;    // with static surfaces
  // One a spring, not 0 once it has torn; empty if the blueprint cannot tear and the body has not been cut.
  std::vector<std::uint8_t> torn;
};

// The rest shape, unturned and whole, with its centre of mass at `position`, m. Every vertex that is not fixed moves at
// `velocity`, m/s; that of planar bodies is projected into their plane.
template <class Real>
[[nodiscard]] State<Real> MakeState(const Blueprint& blueprint, const Vector3d& position, const Vector3d& velocity);

// Resets `state` to the rest shape at `position`, without velocity. Torn springs stay torn.
template <class Real>
void PutBackToRest(const Blueprint& blueprint, const Vector3d& position, State<Real>& state);

// Moves the origin by whole steps if the body has strayed from it; positions and anchors follow. centre: of mass, in
// local coordinates, m.
template <class Real>
void Recentre(const Blueprint& blueprint, const Vector3d& centre, State<Real>& state);

// Centre of mass in the world, m, and its velocity, m/s.
template <class Real>
[[nodiscard]] Vector3d FindCentre(const Blueprint& blueprint, const State<Real>& state);
template <class Real>
[[nodiscard]] Vector3d FindMeanVelocity(const Blueprint& blueprint, const State<Real>& state);

// Hashes. `hash`: kHashSeed or the result of an earlier call. FNV-1a over 32-bit words, with a shift after each; bytes
// after the last whole word are ignored. HashState mixes origin, positions, velocities and torn springs.
inline constexpr std::uint64_t kHashSeed = 0xCBF29CE484222325U;
[[nodiscard]] std::uint64_t HashBytes(std::span<const std::byte> bytes, std::uint64_t hash);
template <class Real>
[[nodiscard]] std::uint64_t HashState(const State<Real>& state, std::uint64_t hash);

}  // namespace wobble::physics
