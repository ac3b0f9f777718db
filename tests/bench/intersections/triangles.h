// Whether two triangles in space intersect, decided exactly.
//
// Two triangles intersect when a point lies in the interior of both: the open triangles, without sides and corners,
// have a point in common. So triangles that touch in a point or along a line do not intersect, nor does one whose side
// or corner lies in the other's plane. A triangle without area has no interior and intersects nothing. Corners that
// both have in common need no rule of their own: the point or side in common belongs to no interior.
//
// Triangles in one plane whose areas overlap are told apart from those that pass through each other: two boxes laid
// flat upon one another touch so, whereas a planar body that overlaps another is inside it.
#pragma once

#include <array>
#include <cstdint>

#include "server/physics/model/vector.h"

namespace wobble::bench {

// A position in the world, exactly `near` + `rest`, m. A body's origin plus a local coordinate need not be a double.
struct ExactPoint {
  std::array<double, 3> near{};  // the sum, rounded to the nearest double
  std::array<double, 3> rest{};  // what the rounding left out

  [[nodiscard]] bool IsFinite() const;
};

// Without error (Knuth's two-sum); infinite or NaN parts where a sum is not finite.
[[nodiscard]] ExactPoint AddExactly(const physics::Vector3d& origin, const physics::Vector3d& local);

// Corners that are the same point in memory count as equal without arithmetic. All finite.
using Triangle = std::array<const ExactPoint*, 3>;

enum class Crossing : std::uint8_t {
  kNone,     // no point lies in the interior of both
  kThrough,  // each passes through the other's plane, and their interiors have a line in common
  kInPlane,  // both lie in one plane, and their areas overlap
};

// How often signs were asked for, and how often double precision could not tell.
struct SignCounts {
  std::uint64_t asked = 0;
  std::uint64_t exact = 0;
};

// Cost: some 100 operations, or a few microseconds where doubles cannot tell.
[[nodiscard]] Crossing FindCrossing(const Triangle& s, const Triangle& t, SignCounts& counts);

// Sign of (b − a) × (c − a) · (p − a): 1 where the corners go round counter-clockwise seen from p; 0 in the plane.
[[nodiscard]] int FindSide(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c, const ExactPoint& p,
                           SignCounts& counts);
// The same sign without double precision: what FindSide falls back on.
[[nodiscard]] int FindSideExactly(const ExactPoint& a, const ExactPoint& b, const ExactPoint& c, const ExactPoint& p);

}  // namespace wobble::bench
