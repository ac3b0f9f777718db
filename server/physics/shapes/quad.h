// The squares of a grid as faces, for cloths and lattices.
#pragma once

#include <cstdint>
#include <vector>

#include "server/physics/model/topology.h"

namespace wobble::physics {

// Adds the square a b c d, counter-clockwise seen from outside, as two faces, cut from a to c or, when `other`, from b
// to d. With alternating cuts a grid bends alike both ways.
inline void AddQuad(std::uint16_t a, std::uint16_t b, std::uint16_t c, std::uint16_t d, bool other,
                    std::vector<Face>& faces) {
  if (!other) {
    faces.push_back({a, b, c});
    faces.push_back({a, c, d});
  } else {
    faces.push_back({a, b, d});
    faces.push_back({b, c, d});
  }
}

}  // namespace wobble::physics
