#include "server/physics/methods/recovery.h"

#include <algorithm>
#include <cmath>

#include "server/physics/methods/elasticity.h"
#include "server/physics/methods/stability.h"
#include "server/physics/methods/unfolding.h"
#include "server/physics/model/rotation.h"

namespace wobble::physics {
namespace {

// For so long nothing draws a body that has lost its shape, s: in play most open by themselves.
constexpr double kAimDelay = 0.2;
// In which the aim grows to its full strength, s.
constexpr double kGrowTime = 0.4;
// Any direction along which bodies have no edges.
const Vector3d kOddDirection(0.348, -0.557, 0.754);
// For each corner of an element the other three, so that the edges to them are right-handed.
constexpr std::size_t kOthers[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};

// Twice the area between two vectors in the plane, positive where the second points to the left of the first.
template <class Real>
Real Cross(const Vector3<Real>& a, const Vector3<Real>& b) {
  return a.x() * b.z() - b.x() * a.z();
}

template <class Real>
Vector3<Real> EdgeAt(std::span<const std::array<std::uint16_t, 2>> outline, std::span<const Vector3<Real>> x,
                     std::size_t edge) {
  return x[outline[edge][1]] - x[outline[edge][0]];
}

// The rest shape laid over the body.
struct Fit {
  Vector3d centre = Vector3d::Zero();
  Stretches turn;

  [[nodiscard]] Vector3d Place(const Vector3d& rest) const {
    Vector3d place = centre;
    for (std::size_t i = 0; i < 3; ++i) place += turn.right[i].dot(rest) * turn.left[i];
    return place;
  }
};

template <class Real>
Fit FindFit(const Coefficients<Real>& body, std::span<const Vector3<Real>> x) {
  Fit fit;
  double mass = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    fit.centre += double{body.masses[i]} * x[i].template cast<double>();
    mass += double{body.masses[i]};
  }
  fit.centre /= mass;
  Columns sum{Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero()};
  double squares = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vector3d at = double{body.masses[i]} * (x[i].template cast<double>() - fit.centre);
    const Vector3d& rest = body.aim.rest[i];
    for (int axis = 0; axis < 3; ++axis) sum[static_cast<std::size_t>(axis)] += rest[axis] * at;
    squares += double{body.masses[i]} * (rest.dot(rest) + at.dot(at));
  }
  // A planar body must not be turned over: that would mirror it in its plane.
  if (body.planar) sum[1] = squares * Vector3d::UnitY();
  fit.turn = FindStretches(sum);
  return fit;
}

template <class Real>
void AddShapeMatching(const Coefficients<Real>& body, double factor, std::span<const Vector3<Real>> x,
                      std::span<const Vector3<Real>> v, std::span<Vector3<Real>> forces) {
  const Fit fit = FindFit(body, x);
  const std::vector<double> masses(body.masses.begin(), body.masses.end());
  std::vector<Vector3d> places;
  std::vector<Vector3d> rates;
  for (std::size_t i = 0; i < x.size(); ++i) {
    places.push_back(x[i].template cast<double>());
    rates.push_back(v[i].template cast<double>());
  }
  RemoveRigidMotion(masses, places, rates);
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Vector3d pull =
        factor * body.aim.squareFrequency * (places[i] - fit.Place(body.aim.rest[i])) + body.aim.damping * rates[i];
    forces[i] -= (masses[i] * pull).template cast<Real>();
  }
}

// Of a planar body.
template <class Real>
bool HasFaceInsideOut(const Coefficients<Real>& body, std::span<const Vector3<Real>> x) {
  return std::ranges::any_of(body.faces, [&](const Face& face) {
    return !(Cross<Real>(x[face[1]] - x[face[0]], x[face[2]] - x[face[0]]) > Real(0));
  });
}

// Whether a direction lies between three edges that are right-handed, of which these are the products of each two.
template <class Real>
bool Holds(const Vector3<Real>& direction, const Vector3<Real>& bc, const Vector3<Real>& ca, const Vector3<Real>& ab) {
  return direction.dot(bc) > Real(0) && direction.dot(ca) > Real(0) && direction.dot(ab) > Real(0);
}

// Whether an element is inside out, or elements go round one of their vertices twice: then two of those that meet there
// hold the same direction.
template <class Real>
bool HasElementFolded(const Coefficients<Real>& body, std::span<const Vector3<Real>> x) {
  const Vector3<Real> direction = kOddDirection.template cast<Real>();
  std::vector<bool> isHeld(x.size(), false);
  for (const Tetrahedron<Real>& element : body.tetrahedra) {
    for (std::size_t i = 0; i < 4; ++i) {
      const std::uint16_t own = element.vertices[i];
      const Vector3<Real> a = x[element.vertices[kOthers[i][0]]] - x[own];
      const Vector3<Real> b = x[element.vertices[kOthers[i][1]]] - x[own];
      const Vector3<Real> c = x[element.vertices[kOthers[i][2]]] - x[own];
      const Vector3<Real> bc = b.cross(c);
      if (i == 0 && !(a.dot(bc) > Real(0))) return true;
      const bool holds = Holds<Real>(direction, bc, c.cross(a), a.cross(b));
      if (holds && isHeld[own]) return true;
      if (holds) isHeld[own] = true;
    }
  }
  return false;
}

// Of a shell whose faces all look away from its centre at rest: whether one of them looks inward, or the skin goes
// round the centre twice. Where none looks inward, it covers every direction equally often, so one direction tells.
template <class Real>
bool HasSkinFolded(const Coefficients<Real>& body, std::span<const Vector3<Real>> x) {
  Vector3<Real> sum = Vector3<Real>::Zero();
  for (const Vector3<Real>& at : x) sum += at;
  const Vector3<Real> centre = sum / static_cast<Real>(x.size());
  const Vector3<Real> direction = kOddDirection.template cast<Real>();
  int covered = 0;
  for (const Face& face : body.faces) {
    const Vector3<Real> a = x[face[0]] - centre;
    const Vector3<Real> b = x[face[1]] - centre;
    const Vector3<Real> c = x[face[2]] - centre;
    const Vector3<Real> bc = b.cross(c);
    if (!(a.dot(bc) > Real(0))) return true;
    if (Holds<Real>(direction, bc, c.cross(a), a.cross(b))) ++covered;
  }
  return covered > 1;
}

}  // namespace

template <class Real>
int FindTurningNumber(std::span<const std::array<std::uint16_t, 2>> outline, std::span<const Vector3<Real>> x) {
  // The direction passes that of +x as often as it goes round, counted with its sign.
  int turns = 0;
  Vector3<Real> before = EdgeAt(outline, x, outline.size() - 1);
  for (std::size_t edge = 0; edge < outline.size(); ++edge) {
    const Vector3<Real> along = EdgeAt(outline, x, edge);
    const bool wasUp = before.z() >= Real(0);
    const bool isUp = along.z() >= Real(0);
    if (wasUp != isUp) {
      const bool turnsLeft = Cross<Real>(before, along) > Real(0);
      if (isUp && turnsLeft) ++turns;
      if (wasUp && !turnsLeft) --turns;
    }
    before = along;
  }
  return turns;
}

template <class Real>
bool HasLostShape(const Coefficients<Real>& body, std::span<const Vector3<Real>> x) {
  if (!body.cells.first.empty()) return HasFolds<Real>(body.cells, x);
  if (!body.tetrahedra.empty()) return HasElementFolded(body, x);
  if (body.aim.rest.empty()) return false;
  if (body.outline.empty()) return HasSkinFolded(body, x);
  if (FindTurningNumber<Real>(body.outline, x) != 1) return true;
  // The faces of a ring of one layer only cover what is inside.
  return body.outline.size() < body.masses.size() && HasFaceInsideOut(body, x);
}

template <class Real>
RecoveryFactors FindRecoveryFactors(const Coefficients<Real>& body, double time, double lost, double stiffnessFactor) {
  const double fold = body.cells.first.empty() ? 0 : FindFoldStrength(time);
  const double aim = body.aim.rest.empty() ? 0 : std::clamp((lost - kAimDelay) / kGrowTime, 0.0, 1.0);
  return {.fold = stiffnessFactor * fold, .aim = stiffnessFactor * aim};
}

double FindSoftening(const Blueprint& blueprint, const Stiffening& stiffening, bool hasLostShape, double tick) {
  if (blueprint.full.tetrahedra.empty()) return 1;
  // Some of the rate is for contacts and for what changes within the tick.
  const double rate = (hasLostShape ? 0.5 : 0.9) * kMaxSubsteps * kStabilityLimit / tick;
  const double squareFrequency = blueprint.angularFrequency * blueprint.angularFrequency * stiffening.squareFrequency;
  const double damping = blueprint.dampingRate * stiffening.dampingRate;
  return std::min({1.0, rate * rate / squareFrequency, damping > rate ? rate / damping : 1.0});
}

template <class Real>
void AddRecovery(const Coefficients<Real>& body, const RecoveryFactors& factors, std::span<const Vector3<Real>> x,
                 std::span<const Vector3<Real>> v, std::span<Vector3<Real>> forces) {
  if (factors.fold > 0) AddUnfolding<Real>(body.cells, static_cast<Real>(factors.fold), x, v, forces);
  if (factors.aim > 0) AddShapeMatching<Real>(body, factors.aim, x, v, forces);
}

double ComputeRecoveryEnergy(const Coefficients<double>& body, const RecoveryFactors& factors,
                             std::span<const Vector3d> x) {
  double energy = factors.fold > 0 ? factors.fold * ComputeFoldEnergy(body.cells, x) : 0;
  if (!(factors.aim > 0)) return energy;
  const Fit fit = FindFit(body, x);
  double squares = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    squares += body.masses[i] * (x[i] - fit.Place(body.aim.rest[i])).squaredNorm();
  }
  return energy + factors.aim * body.aim.squareFrequency / 2 * squares;
}

#define WOBBLE_INSTANTIATE(Real)                                                                                       \
  template int FindTurningNumber<Real>(std::span<const std::array<std::uint16_t, 2>>, std::span<const Vector3<Real>>); \
  template bool HasLostShape<Real>(const Coefficients<Real>&, std::span<const Vector3<Real>>);                         \
  template RecoveryFactors FindRecoveryFactors<Real>(const Coefficients<Real>&, double, double, double);               \
  template void AddRecovery<Real>(const Coefficients<Real>&, const RecoveryFactors&, std::span<const Vector3<Real>>,   \
                                  std::span<const Vector3<Real>>, std::span<Vector3<Real>>);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
