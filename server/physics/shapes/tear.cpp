#include "server/physics/shapes/tear.h"
#include "server/physics/shapes/finish_blueprint.h"

#include <algorithm>
#include <cassert>
#include <set>

namespace wobble::physics {
namespace {

using EdgeKey = std::array<std::uint32_t, 2>;

EdgeKey MakeEdgeKey(std::uint32_t a, std::uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

template <class Real>
void RemoveSprings(std::span<const std::uint8_t> torn, std::vector<Spring<Real>>& springs) {
  std::size_t kept = 0;
  for (std::size_t i = 0; i < springs.size(); ++i) {
    if (torn[i] == 0) springs[kept++] = springs[i];
  }
  springs.resize(kept);
}

// gone: the torn springs' ends.
template <class Real>
void RemoveHinges(const std::set<EdgeKey>& gone, std::vector<Hinge<Real>>& hinges) {
  std::erase_if(hinges, [&](const Hinge<Real>& hinge) {
    const auto& [a, b, c, d] = hinge.vertices;
    return gone.contains(MakeEdgeKey(a, b)) || gone.contains(MakeEdgeKey(a, c)) || gone.contains(MakeEdgeKey(b, d)) ||
           gone.contains(MakeEdgeKey(c, d));
  });
}

// The edges stay marked: a body that is cut seldom looks alike all over, and then corners are looked at one by one.
template <class Real>
void RemoveCells(const std::set<EdgeKey>& gone, Cells<Real>& cells) {
  const std::uint32_t along[] = {cells.strides[0], cells.strides[1], cells.strides[2]};
  std::erase_if(cells.first, [&](std::uint32_t first) {
    for (std::uint32_t bits = 0; bits < 8; ++bits) {
      const std::uint32_t own = first + (bits & 1U) * along[0] + (bits >> 1U & 1U) * along[1] + (bits >> 2U) * along[2];
      for (std::uint32_t axis = 0; axis < 3; ++axis) {
        if ((bits >> axis & 1U) == 0 && gone.contains(MakeEdgeKey(own, own + along[axis]))) return true;
      }
    }
    return false;
  });
}

}  // namespace

template <class Real>
std::size_t FindTorn(const Coefficients<Real>& body, std::span<const Vector3<Real>> x, std::span<std::uint8_t> torn) {
  std::size_t found = 0;
  if (!(body.tearStretch > Real(0))) return found;
  for (std::size_t i = 0; i < torn.size(); ++i) {
    if (torn[i] != 0) continue;
    const Spring<Real>& spring = body.springs[i];
    const Vector3<Real> l = x[spring.a] - x[spring.b];
    const Real longest = body.tearStretch * spring.restLength;
    if (!(l.dot(l) > longest * longest)) continue;
    torn[i] = 1;
    ++found;
  }
  return found;
}

// Compares the signs of volumes (Segura & Feito 2001, "Algorithms to test ray-triangle intersection"). A side that two
// blades share has the same volume in both, bit for bit, with opposite signs, so no spring slips through between them.
bool IsCrossed(const Vector3d& p, const Vector3d& q, const Blade& blade) {
  const Vector3d area = (blade[1] - blade[0]).cross(blade[2] - blade[0]);
  const double play = kBladePlay * area.norm();
  const bool isBehind = area.dot(p - blade[0]) < -play;
  if (isBehind == (area.dot(q - blade[0]) < -play)) return false;
  const Vector3d along = q - p;
  bool left = true;
  bool right = true;
  for (std::size_t i = 0; i < 3; ++i) {
    const double volume = along.dot((blade[i] - p).cross(blade[(i + 1) % 3] - p));
    left = left && volume >= 0;
    right = right && volume <= 0;
  }
  return left || right;
}

template <class Real>
std::size_t FindCut(const Coefficients<Real>& body, const Blade& blade, std::span<const Vector3<Real>> x,
                    std::span<std::uint8_t> torn) {
  std::size_t found = 0;
  for (std::size_t i = 0; i < torn.size(); ++i) {
    const Spring<Real>& spring = body.springs[i];
    if (torn[i] != 0) continue;
    if (!IsCrossed(x[spring.a].template cast<double>(), x[spring.b].template cast<double>(), blade)) continue;
    torn[i] = 1;
    ++found;
  }
  return found;
}

Blueprint MakeTornBlueprint(const Blueprint& blueprint, std::span<const std::uint8_t> torn) {
  assert(torn.size() == blueprint.full.springs.size());
  assert(blueprint.full.gas == 0);
  std::set<EdgeKey> gone;
  for (std::size_t i = 0; i < torn.size(); ++i) {
    const Spring<double>& spring = blueprint.full.springs[i];
    if (torn[i] != 0) gone.insert(MakeEdgeKey(spring.a, spring.b));
  }
  Blueprint left = blueprint;
  RemoveSprings(torn, left.full.springs);
  RemoveSprings(torn, left.single.springs);
  RemoveHinges(gone, left.full.hinges);
  RemoveHinges(gone, left.single.hinges);
  std::erase_if(left.full.faces, [&](const Face& face) {
    return gone.contains(MakeEdgeKey(face[0], face[1])) || gone.contains(MakeEdgeKey(face[1], face[2])) ||
           gone.contains(MakeEdgeKey(face[2], face[0]));
  });
  left.single.faces = left.full.faces;
  RemoveCells(gone, left.full.cells);
  RemoveCells(gone, left.single.cells);
  left.full.aim = left.single.aim = {};
  left.topology = MakeTopology(left.full.faces, left.rest.size());
  MakePlans(left);
  return left;
}

template std::size_t FindTorn<float>(const Coefficients<float>&, std::span<const Vector3f>, std::span<std::uint8_t>);
template std::size_t FindTorn<double>(const Coefficients<double>&, std::span<const Vector3d>, std::span<std::uint8_t>);
template std::size_t FindCut<float>(const Coefficients<float>&, const Blade&, std::span<const Vector3f>,
                                    std::span<std::uint8_t>);
template std::size_t FindCut<double>(const Coefficients<double>&, const Blade&, std::span<const Vector3d>,
                                     std::span<std::uint8_t>);

}  // namespace wobble::physics
