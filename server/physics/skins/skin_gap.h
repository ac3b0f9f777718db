// The gap at which two skins begin to push one another (Skin::offset), so that bodies that press do not intersect.
//
// A penalty needs depth to push. Where the depth counts from the skin itself, bodies at rest on one another are in one
// another, by some millimetres. Counted from a gap above it, they rest within the gap.
//
// Bodies that are put down flush, or in one another, begin within the gap. Depth that nobody pressed would throw them
// apart. So a pair begins with the gap that it finds, at most the full one, and the gap widens slowly: the upper body
// of a stack is lifted by it like by a jack. Counted as leap of each contact instead (BodyContact::leap), the depth
// stayed for as long as the bodies touched, and a cube stuck on a slab up to 18° where friction ends at 11°.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "server/physics/model/blueprint.h"
#include "server/physics/skins/body_contact.h"

namespace wobble::physics {

// The full gap of a body, as a share of Blueprint::size, and its upper bound, m. A penalty gives way by more under
// larger bodies; a centimetre between bodies of a metre is not seen.
inline constexpr double kGapShare = 0.02;
inline constexpr double kLargestGap = 0.01;
// At which a gap widens, m/s: slow against all play, and above kQuietSpeed (step/sleep.h), so that bodies do not fall
// asleep before it is full.
inline constexpr double kGapSpeed = 0.02;

// The full gap between two bodies, m. Rods have a radius instead, and planar bodies meet one another by their outlines.
[[nodiscard]] inline double FindFullGap(const Blueprint& first, const Blueprint& second) {
  const bool inOnePlane = first.full.planar && second.full.planar;
  if (inOnePlane || first.full.faces.empty() || second.full.faces.empty()) return 0;
  return std::min(kLargestGap, kGapShare * std::min(first.size, second.size));
}

// Skin::fadingGap of a pair with this gap: all of it where both bodies are closed.
[[nodiscard]] inline double FindFadingGap(const Blueprint& first, const Blueprint& second, double gap) {
  return first.topology.isOpen || second.topology.isOpen ? 0 : gap;
}

// Both lists of a pair's contacts.
template <class Real>
using PairSides = std::array<std::vector<BodyContact<Real>>, 2>;

// Sets the gap of a pair and adds the change to the depths that its contacts remember: it is no motion of theirs.
template <class Real>
void SetGap(double to, double& gap, PairSides<Real>& sides) {
  const auto more = static_cast<Real>(to - gap);
  gap = to;
  for (std::vector<BodyContact<Real>>& contacts : sides) {
    for (BodyContact<Real>& contact : contacts) contact.depth += more;
  }
}

// Finds the contacts of a pair in a tick of `duration` s, by find(side) for each of its sides. A gap never narrows
// while the pair has contacts; that of a pair without begins with what is found.
template <class Real, class Find>
void FindWithGap(double full, double duration, double& gap, PairSides<Real>& sides, const Find& find) {
  const bool hasMet = !sides[0].empty() || !sides[1].empty();
  if (hasMet) {
    SetGap(std::max(gap, std::min(full, gap + kGapSpeed * duration)), gap, sides);
  } else {
    gap = 0;
  }
  for (const std::size_t side : {0U, 1U}) find(side);
  if (hasMet) return;
  double nearest = full;
  for (const std::vector<BodyContact<Real>>& contacts : sides) {
    for (const BodyContact<Real>& contact : contacts)
      nearest = std::min(nearest, -double{contact.depth + contact.leap});
  }
  SetGap(std::max(nearest, 0.0), gap, sides);
}

}  // namespace wobble::physics
