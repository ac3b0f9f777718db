// Springs that tear, by themselves or by a blade. A torn spring is torn for good: first the body's state says so, and
// once somebody has made the blueprint without it, it is as if it had never been.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "server/physics/model/blueprint.h"

namespace wobble::physics {

// Marks springs that are longer than `tearStretch` times their rest length. Returns how many are new: none where the
// blueprint cannot tear. torn: State::torn.
template <class Real>
[[nodiscard]] std::size_t FindTorn(const Coefficients<Real>& body, std::span<const Vector3<Real>> x,
                                   std::span<std::uint8_t> torn);

// The corners of a triangle that cuts what crosses it, m.
using Blade = std::array<Vector3d, 3>;

// Nearer to a blade's plane than this, m, a point counts as in front of it, on the side that sees the corners go round
// counter-clockwise: ten times what single precision resolves of a body of a metre.
inline constexpr double kBladePlay = 1e-6;

// Whether the segment from p to q goes through the blade from one side of its plane to the other; its border counts, so
// blades side by side leave no gap. What lies in the plane is not crossed, and of two springs that meet in it, one on
// each side, the blade cuts the one behind: a cut along a row of vertices parts them from one neighbour, not from both.
[[nodiscard]] bool IsCrossed(const Vector3d& p, const Vector3d& q, const Blade& blade);

// Marks whole springs that cross the blade, which is in the coordinates of x. Returns how many. torn: one a spring.
template <class Real>
[[nodiscard]] std::size_t FindCut(const Coefficients<Real>& body, const Blade& blade, std::span<const Vector3<Real>> x,
                                  std::span<std::uint8_t> torn);

// The blueprint without these springs and without the faces that had one of them for a side. Vertices, masses, contact
// and stability stay: what is taken away only makes a body slower. Not for a body with gas, which would leak.
[[nodiscard]] Blueprint MakeTornBlueprint(const Blueprint& blueprint, std::span<const std::uint8_t> torn);

}  // namespace wobble::physics
