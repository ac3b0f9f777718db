// A spring as the sweep sees it.
#pragma once

#include <cstdint>

namespace wobble::physics {

// Of the vertex that the sweep is at, to one further on. Its force along l = x − x_other is
// −[k − k r/|l| + c (l̇·l)/|l|²] l.
template <class Real>
struct Arc {
  std::uint32_t other = 0;   // place
  Real stiffness = 0;        // k, N/m
  Real stiffnessAtRest = 0;  // k r, N
  Real damping = 0;          // c, N·s/m
};

}  // namespace wobble::physics
