// What takes a second turn out of the outline of a planar body with gas.
//
// Going once round an outline, its direction turns by 2π N; N is the turning number, 1 at rest. No motion of a smooth
// curve changes it (Whitney 1937, "On regular closed curves in the plane"); a polygon changes it where one of its
// corners turns by more than π, a cusp. Where N < 1 the outline has a loop the wrong way round, which the gas presses
// flat until it comes out through a cusp by itself. Where N > 1 a loop goes the right way round, and the gas holds it
// open: a ring wound twice is in balance. So a couple bends the outline's sharpest corner further, until it has turned
// by more than π.
//
// The couple is constant through a tick, like a player's push: a force on each of the corner's neighbours across its
// edge, of the same torque and of opposite signs, and the opposite of both on the corner. So momentum and angular
// momentum stay as they are.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "server/physics/methods/forces.h"
#include "server/physics/model/blueprint.h"

namespace wobble::physics {

// N of a closed outline, counter-clockwise as seen from −y. A corner of exactly π counts as turning either way.
template <class Real>
[[nodiscard]] int FindTurningNumber(std::span<const std::array<std::uint16_t, 2>> outline,
                                    std::span<const Vector3<Real>> x);

// The forces, N, on the sharpest corner of an outline and on its neighbours. The body has gas and an outline.
template <class Real>
[[nodiscard]] std::array<VertexForce<Real>, 3> FindUnwinding(const Coefficients<Real>& body,
                                                             std::span<const Vector3<Real>> x);

}  // namespace wobble::physics
