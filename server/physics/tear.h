// Springs that tear. A torn spring is torn for good: first the body's state says so, and once somebody has made the
// blueprint without it, it is as if it had never been.
#pragma once

#include <cstdint>
#include <span>

#include "server/physics/blueprint.h"

namespace wobble::physics {

// Marks springs that are longer than `tearStretch` times their rest length. Returns how many are new. torn: one a
// spring, not 0 once torn; empty where the blueprint cannot tear.
template <class Real>
[[nodiscard]] std::size_t FindTorn(const Coefficients<Real>& body, std::span<const Vector3<Real>> x,
                                   std::span<std::uint8_t> torn);

// The blueprint without these springs and without the faces that had one of them for a side. Vertices, masses, contact
// and stability stay: what is taken away only makes a body slower. Not for a body with gas, which would leak.
[[nodiscard]] Blueprint MakeTornBlueprint(const Blueprint& blueprint, std::span<const std::uint8_t> torn);

}  // namespace wobble::physics
