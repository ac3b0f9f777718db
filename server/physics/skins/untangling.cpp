#include "server/physics/skins/untangling.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace wobble::physics {
namespace {

using Triangle = UntanglingScratch::Triangle;

// Ticks without a look, at a pair without tension. Looks at two closed bodies in every eighth tick were 8 % of a
// crowd's time.
constexpr int kTicksUntilLook = 3;
constexpr int kTicksUntilSlowLook = kMostTicksUntilLook;
constexpr double kGrowTime = 0.1;          // s
constexpr double kSlowDelay = 1;           // s, of pairs that are left to their contacts
constexpr double kSlowGrowTime = 4;        // s
constexpr double kHard = 5;                // of bodies against one another, m/s
constexpr double kFast = 10;               // the same
constexpr double kFrequency = 30;          // ω, rad/s
constexpr double kMostAcceleration = 150;  // of a vertex with one passage, m/s²
constexpr double kCalm = 10;               // u₀, m/s
constexpr double kMostTickAngle = 0.5;     // of ωt
constexpr double kMostLeverage = 3;        // of c, above
constexpr double kLeastSine = 1e-9;        // of the angle between two faces that have a line in common

// Both bodies in the coordinates of the first, m.
template <class Real>
class View {
 public:
  View(const TangledSkin<Real>& first, const TangledSkin<Real>& second, const Vector3d& shift)
      : m_skins{&first, &second}, m_shift(shift), m_isSelf(first.x.data() == second.x.data()) {}

  [[nodiscard]] bool IsSelf() const { return m_isSelf; }
  // 1 + (u/u₀)².
  [[nodiscard]] double FindUnrest() const {
    const double u = std::max(m_skins[0]->agitation, m_skins[1]->agitation) / kCalm;
    return 1 + u * u;
  }
  [[nodiscard]] const Blueprint& BlueprintOf(std::size_t body) const { return *m_skins[body]->blueprint; }
  [[nodiscard]] const Face& FaceOf(const Triangle& triangle) const {
    return BlueprintOf(triangle.body).full.faces[triangle.face];
  }
  [[nodiscard]] Vector3d At(std::size_t body, std::uint16_t vertex) const {
    const Vector3d local = m_skins[body]->x[vertex].template cast<double>();
    return body == 0 ? local : Vector3d(local + m_shift);
  }

  // Fills in the faces of both bodies that reach into what both have in common, by their low end along x.
  void ListNear(UntanglingScratch& scratch) const {
    scratch.near.clear();
    const Eigen::AlignedBox3d common = BoxOf(0).intersection(BoxOf(1));
    if (common.isEmpty()) return;
    const Slab slab = FindSlab();
    if (slab.high < slab.low) return;
    for (std::uint8_t body = 0; body < (m_isSelf ? 1 : 2); ++body) AddNear(body, common, slab, scratch);
    std::ranges::sort(scratch.near, [](const Triangle& a, const Triangle& b) {
      const double lowA = a.box.min().x();
      const double lowB = b.box.min().x();
      if (lowA != lowB) return lowA < lowB;
      return a.body != b.body ? a.body < b.body : a.face < b.face;
    });
  }

 private:
  [[nodiscard]] Vector3d ShiftOf(std::size_t body) const { return body == 0 ? Vector3d(Vector3d::Zero()) : m_shift; }

  [[nodiscard]] Eigen::AlignedBox3d BoxOf(std::size_t body) const {
    const Bounds<Real>& bounds = m_skins[body]->bounds;
    return {Vector3d(bounds.low.template cast<double>() + ShiftOf(body)),
            Vector3d(bounds.high.template cast<double>() + ShiftOf(body))};
  }

  // The slab between the second body's lowest and the first one's highest vertex along the line from the middle of the
  // first to that of the second. What the skins have in common is in it. Of two balls that press one another it is
  // thin, while their boxes have much in common where the line is oblique. A body has no such line to itself: there
  // all heights are 0, and the slab holds everything.
  struct Slab {
    Vector3<Real> along;  // m
    Real low, high;       // m²: heights times the length of `along`
  };

  // Along the line, in the coordinates of the first body, m². x: in the body's own.
  [[nodiscard]] Real FindHeight(std::uint8_t body, const Vector3<Real>& along, const Vector3<Real>& x) const {
    return x.dot(along) + ShiftOf(body).template cast<Real>().dot(along);
  }

  [[nodiscard]] Slab FindSlab() const {
    const Vector3d way = BoxOf(1).center() - BoxOf(0).center();
    Slab slab{.along = way.template cast<Real>(),
              .low = std::numeric_limits<Real>::infinity(),
              .high = -std::numeric_limits<Real>::infinity()};
    for (const Vector3<Real>& x : m_skins[0]->x) slab.high = std::max(slab.high, FindHeight(0, slab.along, x));
    for (const Vector3<Real>& x : m_skins[1]->x) slab.low = std::min(slab.low, FindHeight(1, slab.along, x));
    return slab;
  }

  [[nodiscard]] Triangle MakeTriangle(std::uint8_t body, std::size_t face) const {
    const auto& [a, b, c] = BlueprintOf(body).full.faces[face];
    Triangle triangle{.box = {},
                      .corners = {At(body, a), At(body, b), At(body, c)},
                      .doubleArea = {},
                      .face = static_cast<std::uint16_t>(face),
                      .body = body};
    for (const Vector3d& corner : triangle.corners) triangle.box.extend(corner);
    const auto& [x, y, z] = triangle.corners;
    triangle.doubleArea = (y - x).cross(z - x);
    return triangle;
  }

  // Most faces of two bodies that touch are on one side of the box or of the slab: those cost some comparisons.
  void AddNear(std::uint8_t body, const Eigen::AlignedBox3d& common, const Slab& slab,
               UntanglingScratch& scratch) const {
    const std::span<const Vector3<Real>> x = m_skins[body]->x;
    const Vector3<Real> low = (common.min() - ShiftOf(body)).template cast<Real>();
    const Vector3<Real> high = (common.max() - ShiftOf(body)).template cast<Real>();
    scratch.beside.resize(x.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
      const Real height = FindHeight(body, slab.along, x[i]);
      unsigned sides = (height < slab.low ? 1U : 0U) | (height > slab.high ? 2U : 0U);
      for (int axis = 0; axis < 3; ++axis) {
        sides |= (x[i][axis] < low[axis] ? 4U : 0U) << 2 * axis | (x[i][axis] > high[axis] ? 8U : 0U) << 2 * axis;
      }
      scratch.beside[i] = static_cast<std::uint8_t>(sides);
    }
    const std::span<const Face> faces = BlueprintOf(body).full.faces;
    for (std::size_t i = 0; i < faces.size(); ++i) {
      const auto& [a, b, c] = faces[i];
      if ((scratch.beside[a] & scratch.beside[b] & scratch.beside[c]) != 0) continue;
      scratch.near.push_back(MakeTriangle(body, i));
    }
  }

  std::array<const TangledSkin<Real>*, 2> m_skins;
  Vector3d m_shift;
  bool m_isSelf;
};

// A side of a face passes through another face.
struct Corner {
  double along = 0;                     // from the begin of the side to its end, 0 to 1
  Vector3d weights = Vector3d::Zero();  // of the corners of the face
  Vector3d side = Vector3d::Zero();     // direction, a unit
  Vector3d normal = Vector3d::Zero();   // of the face, a unit
};

// over, under: (begin − face.corners[0])·face.doubleArea, and that of `end`, of different signs.
std::optional<Corner> FindCorner(const Vector3d& begin, double over, const Vector3d& end, double under,
                                 const Triangle& face) {
  const auto& [a, b, c] = face.corners;
  Corner corner;
  corner.along = over / (over - under);
  const Vector3d at = begin + corner.along * (end - begin);
  const double square = face.doubleArea.squaredNorm();
  if (!(square > 0)) return std::nullopt;
  corner.weights[0] = (c - b).cross(at - b).dot(face.doubleArea) / square;
  corner.weights[1] = (a - c).cross(at - c).dot(face.doubleArea) / square;
  corner.weights[2] = 1 - corner.weights[0] - corner.weights[1];
  if (!(corner.weights.minCoeff() >= 0)) return std::nullopt;
  corner.side = (end - begin).normalized();
  corner.normal = face.doubleArea / std::sqrt(square);
  return corner;
}

// The direction in which the contour goes on from a corner along a face at the side; toWing: from the side to that
// face's third vertex, m. Zero where that face lies in the other.
Vector3d FindContour(const Corner& corner, const Vector3d& toWing) {
  const Vector3d line = corner.side.cross(toWing).cross(corner.normal);
  const double length = line.norm();
  if (!(length > kLeastSine * toWing.norm())) return Vector3d::Zero();
  const Vector3d inward = toWing - corner.side.dot(toWing) * corner.side;
  return line / (line.dot(inward) < 0 ? -length : length);
}

// Adds the forces of the sides of `a` that pass through `b`. Each side belongs to one of its faces. True where one
// does.
template <class Real>
bool AddForcesOfSides(const View<Real>& view, const Triangle& a, const Triangle& b, double tension,
                      std::array<std::vector<Vector3d>, 2>& forces) {
  const std::array<Vector3d, 3>& own = a.corners;
  std::array<double, 3> over{};
  for (std::size_t i = 0; i < 3; ++i) over[i] = (own[i] - b.corners[0]).dot(b.doubleArea);
  if ((over[0] > 0) == (over[1] > 0) && (over[0] > 0) == (over[2] > 0)) return false;
  const Topology& topology = view.BlueprintOf(a.body).topology;
  const Face& ofSides = view.FaceOf(a);
  const Face& other = view.FaceOf(b);
  bool found = false;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t from = (i + 1) % 3;
    const std::size_t to = (i + 2) % 3;
    if ((over[from] > 0) == (over[to] > 0)) continue;
    const std::uint16_t neighbour = topology.neighbours[a.face][i];
    if (neighbour != kNoFace && neighbour < a.face) continue;
    const std::uint16_t begin = ofSides[from];
    const std::uint16_t end = ofSides[to];
    const auto isItsCorner = [&](std::uint16_t vertex) { return std::ranges::find(other, vertex) != other.end(); };
    if (view.IsSelf() && (isItsCorner(begin) || isItsCorner(end))) continue;
    const std::optional<Corner> corner = FindCorner(own[from], over[from], own[to], over[to], b);
    if (!corner) continue;
    found = true;
    if (!(tension > 0)) continue;
    Vector3d contour = FindContour(*corner, own[i] - own[from]);
    if (neighbour != kNoFace) contour += FindContour(*corner, view.At(a.body, topology.across[a.face][i]) - own[from]);
    const double leverage = contour.dot(corner->side) / corner->side.dot(corner->normal);
    const double bounded = std::max(-kMostLeverage, std::min(kMostLeverage, leverage));  // finite for 0/0 as well
    const Vector3d onFace = tension * bounded * corner->normal;
    const Vector3d onSide = tension * contour - onFace;
    forces[a.body][begin] += (1 - corner->along) * onSide;
    forces[a.body][end] += corner->along * onSide;
    for (std::size_t j = 0; j < 3; ++j) forces[b.body][other[j]] += corner->weights[static_cast<int>(j)] * onFace;
  }
  return found;
}

// The tension of a contour with this body, N: m a above, of the mean of its vertices and sides.
double FindTension(const Blueprint& blueprint, double frequency) {
  const double acceleration = std::min(frequency * frequency * blueprint.sideLength, kMostAcceleration);
  return acceleration * blueprint.totalMass / static_cast<double>(blueprint.rest.size());
}

template <class Real>
void Append(const std::vector<Vector3d>& forces, bool isPlanar, std::vector<VertexForce<Real>>& pulls) {
  for (std::size_t i = 0; i < forces.size(); ++i) {
    Vector3d force = forces[i];
    if (isPlanar) force.y() = 0;
    if (force.isZero(0)) continue;
    pulls.push_back({static_cast<std::uint16_t>(i), force.template cast<Real>()});
  }
}

// Two closed bodies, and planar ones.
template <class Real>
bool KnowTheirSides(const TangledSkin<Real>& first, const TangledSkin<Real>& second) {
  const bool areClosed = !first.blueprint->topology.isOpen && !second.blueprint->topology.isOpen;
  return areClosed || first.blueprint->full.planar || second.blueprint->full.planar;
}

// Whether the tension waits for kSlowDelay and grows slowly.
template <class Real>
bool AreLeftToContacts(const TangledSkin<Real>& first, const TangledSkin<Real>& second) {
  const double speed = (second.velocity - first.velocity).norm();
  const bool isOneClosed = first.blueprint->topology.isOpen != second.blueprint->topology.isOpen;
  return KnowTheirSides(first, second) || speed > kFast || (isOneClosed && speed < kHard);
}

// A share of the full tension; time: for which the skins have been in one another, s.
double FindGrown(bool isSlow, double time) {
  return std::clamp(isSlow ? (time - kSlowDelay) / kSlowGrowTime : time / kGrowTime, 0.0, 1.0);
}

// Whether they intersect, and where the tension has begun to grow, the forces.
template <class Real>
bool FindPulls(const View<Real>& view, double grown, double tick, UntanglingScratch& scratch, Pulls<Real>& pulls) {
  view.ListNear(scratch);
  if (scratch.near.empty()) return false;
  double tension = 0;
  if (grown > 0) {
    const double frequency = std::min(kFrequency, kMostTickAngle / tick);
    tension = grown / view.FindUnrest() *
              std::min(FindTension(view.BlueprintOf(0), frequency), FindTension(view.BlueprintOf(1), frequency));
  }
  for (std::size_t body = 0; body < 2; ++body) {
    scratch.forces[body].assign(grown > 0 ? view.BlueprintOf(body).rest.size() : 0, Vector3d::Zero());
  }
  bool found = false;
  for (std::size_t i = 0; i < scratch.near.size(); ++i) {
    const Triangle& a = scratch.near[i];
    for (std::size_t j = i + 1; j < scratch.near.size(); ++j) {
      const Triangle& b = scratch.near[j];
      if (b.box.min().x() > a.box.max().x()) break;
      if ((a.body == b.body) != view.IsSelf() || !a.box.intersects(b.box)) continue;
      found |= AddForcesOfSides(view, a, b, tension, scratch.forces);
      found |= AddForcesOfSides(view, b, a, tension, scratch.forces);
      if (found && !(grown > 0)) return true;
    }
  }
  for (std::size_t body = 0; found && body < 2; ++body) {
    Append<Real>(scratch.forces[body], view.BlueprintOf(body).full.planar, pulls[body]);
  }
  return found;
}

}  // namespace

template <class Real>
void Untangle(const TangledSkin<Real>& first, const TangledSkin<Real>& second, const Vector3d& shift, double tick,
              UntanglingScratch& scratch, Tangle& tangle, Pulls<Real>& pulls) {
  for (auto& each : pulls) each.clear();
  if (tangle.untilLook > 0) {
    --tangle.untilLook;
    if (tangle.ticks > 0) tangle.ticks = std::min(tangle.ticks + 1, kMostTangleTicks);
    return;
  }
  const View<Real> view(first, second, shift);
  const double grown = FindGrown(AreLeftToContacts(first, second), (tangle.ticks + 1) * tick);
  const bool found = FindPulls(view, grown, tick, scratch, pulls);
  tangle.ticks = found ? std::min(tangle.ticks + 1, kMostTangleTicks) : 0;
  const int pause = KnowTheirSides(first, second) ? kTicksUntilSlowLook : kTicksUntilLook;
  tangle.untilLook = found && grown > 0 ? 0 : pause;
}

template void Untangle<float>(const TangledSkin<float>&, const TangledSkin<float>&, const Vector3d&, double,
                              UntanglingScratch&, Tangle&, Pulls<float>&);
template void Untangle<double>(const TangledSkin<double>&, const TangledSkin<double>&, const Vector3d&, double,
                               UntanglingScratch&, Tangle&, Pulls<double>&);

}  // namespace wobble::physics
