// What changes about one body: positions and velocities of its vertices.
//
// Positions are local: the world's position is origin + x, with the origin in double precision. A float then resolves
// a body of a metre to 10⁻⁷ m wherever in the world it is, where world coordinates would lose three digits at 100 m and
// let an oscillator far out gain energy. The origin follows the body in steps of a whole power of two.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/physics/model/blueprint.h"
#include "server/physics/model/vector.h"

namespace wobble::physics {

// A vertex near a static surface (contact/contact.h has the laws). The list is sorted by surface, then vertex; anchors
// live through it from tick to tick.
template <class Real>
struct Contact {
  std::uint32_t surface = 0;
  std::uint32_t vertex = 0;
  bool touching = false;                         // at the end of the last substep; the anchor is set
  bool buried = false;                           // in ground that it came into from beside: it feels nothing of it
  Vector3<Real> anchor = Vector3<Real>::Zero();  // local coordinates, m
  Vector3<Real> slip = Vector3<Real>::Zero();    // backtracking: along the surface, at the end of the last substep, m/s
  Vector3<Real> side = Vector3<Real>::Zero();    // normal of the surface where the vertex was last; zero: not yet known
};

template <class Real>
struct State {
  Vector3d origin = Vector3d::Zero();     // m
  std::vector<Vector3<Real>> positions;   // local, m
  std::vector<Vector3<Real>> velocities;  // m/s
  std::vector<Contact<Real>> contacts;    // with static surfaces
  // One a spring, not 0 once it has torn; empty where the blueprint cannot tear and nobody has cut.
  std::vector<std::uint8_t> torn;
};

// The rest shape at `position`, turned by nothing and whole, every vertex that can move moving at `velocity` (planar
// bodies: in their plane).
template <class Real>
[[nodiscard]] State<Real> MakeState(const Blueprint& blueprint, const Vector3d& position, const Vector3d& velocity);

// The same for a body that is there: what has torn stays torn.
template <class Real>
void PutBackToRest(const Blueprint& blueprint, const Vector3d& position, State<Real>& state);

// Moves the origin by whole steps when the body has strayed from it; positions and anchors follow.
// centre: of mass, local coordinates, m.
template <class Real>
void Recentre(const Blueprint& blueprint, const Vector3d& centre, State<Real>& state);

// Centre of mass in the world, m, and its velocity, m/s.
template <class Real>
[[nodiscard]] Vector3d FindCentre(const Blueprint& blueprint, const State<Real>& state);
template <class Real>
[[nodiscard]] Vector3d FindMeanVelocity(const Blueprint& blueprint, const State<Real>& state);

// Mixes every bit of the state into a running hash (FNV-1a over 32-bit words).
inline constexpr std::uint64_t kHashSeed = 0xCBF29CE484222325U;
[[nodiscard]] std::uint64_t HashBytes(std::span<const std::byte> bytes, std::uint64_t hash);
template <class Real>
[[nodiscard]] std::uint64_t HashState(const State<Real>& state, std::uint64_t hash);

}  // namespace wobble::physics
