// Hinges of sheets: where a sheet bends, as an angle spring. The force law is that of methods/bending.h.
#pragma once

#include <array>
#include <cstdint>

namespace wobble::physics {

// Between four vertices a b c d, of which b and c may be one: δ = xₐ − x_b − x_c + x_d. Along a row of a grid, with b =
// c, δ is 2 h sin(θ/2) for two sides of length h that meet at the angle θ; on the corners of a square, with a and d
// opposite each other, it is how far the square is wrung.
template <class Real>
struct Hinge {
  std::array<std::uint16_t, 4> vertices{};
  Real stiffness = 0;  // k, N/m
  Real damping = 0;    // c, N·s/m
};

}  // namespace wobble::physics
