// Springs that tear, when overstretched or cut by a blade. A torn spring is torn for good: at first the body's state
// marks it (State::torn); a few times a second the world makes a blueprint without the marked springs.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "server/physics/model/blueprint.h"

namespace wobble::physics {

// Marks springs that are longer than `tearStretch` times their rest length. Returns the number of newly marked ones:
// 0 where the blueprint cannot tear. torn: State::torn.
template <class Real>
[[nodiscard]] std::size_t FindTorn(const Coefficients<Real>& body, std::span<const Vector3<Real>> x,
                                   std::span<std::uint8_t> torn);

// The corners of a triangle that cuts the springs that cross it, m.
using Blade = std::array<Vector3d, 3>;

// A point nearer to a blade's plane than this, m, counts as in front of it: on the side from which the corners run
// counter-clockwise. Ten times what single precision resolves on a body of one metre.
inline constexpr double kBladePlay = 1e-6;

// Whether the segment from p to q goes through the blade from one side of its plane to the other. The border counts, so
// that blades side by side leave no gap. A segment in the plane does not cross it, and of two springs that meet in the
// plane, one on each side, the blade cuts the one behind: a cut along a row of vertices separates them from one
// neighbour, not from both.
[[nodiscard]] bool IsCrossed(const Vector3d& p, const Vector3d& q, const Blade& blade);

// Marks whole springs that cross the blade, which is in the coordinates of x. Returns their number. torn: one entry a
// spring.
template <class Real>
[[nodiscard]] std::size_t FindCut(const Coefficients<Real>& body, const Blade& blade, std::span<const Vector3<Real>> x,
                                  std::span<std::uint8_t> torn);

// The blueprint without the torn springs, without the faces that had one of them as a side and without the hinges that
// had one of them between neighbours. Vertices, masses, contact and stability stay: fewer springs only lower the
// frequencies. Not for a body with gas, which would leak.
[[nodiscard]] Blueprint MakeTornBlueprint(const Blueprint& blueprint, std::span<const std::uint8_t> torn);

}  // namespace wobble::physics
