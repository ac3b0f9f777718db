// Counts the pairs of triangles of bodies' skins that intersect: an account of contact that shares nothing with the
// engine's contact search. Exact, so a pair that is counted does intersect, and none is missed.
//
// Counted are pairs of triangles whose interiors have a point in common (triangles.h): between bodies, and within a
// body. Bodies without faces (pairs, graphs) have no skin and obstacles no triangles: neither is counted.
//   between bodies   pairs that pass through each other. Pairs that overlap in one plane count where both bodies are
//                    planar; in space they are faces laid upon one another, which is a touch.
//   within a body    pairs that pass through each other, and pairs that overlap in one plane, as where a planar cell is
//                    folded over or a skin is folded exactly flat. Pairs that share a corner count where more than that
//                    corner is in common; pairs that share a side only where they are folded flat upon one another.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "server/physics/world.h"
#include "tests/bench/intersections/triangles.h"

namespace wobble::bench {

// The triangles of one body, at one moment.
struct TriangleSkin {
  std::vector<ExactPoint> points;
  std::span<const physics::Face> faces;
  bool isPlanar = false;
};
// local: in the coordinates of `origin`, m.
[[nodiscard]] TriangleSkin MakeTriangleSkin(std::span<const physics::Face> faces, const physics::Vector3d& origin,
                                            std::span<const physics::Vector3d> local, bool isPlanar = false);
// `faces` is that of the world's blueprint. Without faces if a vertex is not finite.
[[nodiscard]] TriangleSkin MakeTriangleSkin(const physics::World& world, const physics::Body& body);

[[nodiscard]] std::size_t CountBetween(const TriangleSkin& a, const TriangleSkin& b, SignCounts& counts);
[[nodiscard]] std::size_t CountWithin(const TriangleSkin& skin, SignCounts& counts);

// Bodies of at least so many vertices are held to more: they have enough faces for vertices to feel every edge.
inline constexpr std::size_t kFineVertices = 162;

struct Intersections {
  std::size_t betweenFine = 0;    // pairs of triangles of two bodies that both have kFineVertices vertices or more
  std::size_t betweenOthers = 0;  // of any other two bodies
  std::size_t within = 0;         // of one body
  std::size_t vertices = 0;       // of all bodies with faces
  std::size_t fineVertices = 0;   // of those with kFineVertices or more
  SignCounts signs;
};
// O(triangles · those that are beside them along an axis), bodies whose boxes are apart left out.
[[nodiscard]] Intersections CountIntersections(const physics::World& world);

}  // namespace wobble::bench
