// Making, resetting, recentring and hashing a body's state.
#include "server/physics/model/state.h"

#include <cmath>
#include <cstring>

namespace wobble::physics {
namespace {

// The origin moves in steps of the power of two next above the body's reach: it seldom moves, and local coordinates
// stay within a few reaches.
double FindOriginStep(const Blueprint& blueprint) { return std::exp2(std::ceil(std::log2(blueprint.reach))); }

template <class Real>
Vector3d AverageByMass(const Blueprint& blueprint, const std::vector<Vector3<Real>>& values) {
  Vector3d sum = Vector3d::Zero();
  const std::vector<double>& masses = blueprint.full.masses;
  for (std::size_t i = 0; i < values.size(); ++i) sum += masses[i] * values[i].template cast<double>();
  return sum / blueprint.totalMass;
}

}  // namespace

template <class Real>
State<Real> MakeState(const Blueprint& blueprint, const Vector3d& position, const Vector3d& velocity) {
  State<Real> state;
  state.origin = position;
  state.positions.reserve(blueprint.rest.size());
  for (const Vector3d& x : blueprint.rest) state.positions.push_back(x.cast<Real>());
  const Coefficients<double>& full = blueprint.full;
  const Vector3d free = full.planar ? Vector3d(velocity.x(), 0, velocity.z()) : velocity;
  state.velocities.assign(blueprint.rest.size(), free.cast<Real>());
  for (const std::uint16_t vertex : full.fixed) state.velocities[vertex].setZero();
  if (full.tearStretch > 0) state.torn.assign(full.springs.size(), 0);
  return state;
}

template <class Real>
void PutBackToRest(const Blueprint& blueprint, const Vector3d& position, State<Real>& state) {
  const State<Real> rest = MakeState<Real>(blueprint, position, Vector3d::Zero());
  state.origin = rest.origin;
  state.positions = rest.positions;  // a copy: they stay where they are in memory, as wobble_world.h promises
  state.velocities = rest.velocities;
  state.contacts.clear();
}

template <class Real>
void Recentre(const Blueprint& blueprint, const Vector3d& centre, State<Real>& state) {
  const double step = FindOriginStep(blueprint);
  Vector3d shift = Vector3d::Zero();
  for (int axis = 0; axis < 3; ++axis) {
    // The body must stray by a whole step, although half a step would do to round to another origin: with this play, a
    // body that rests on a border does not move its origin every tick.
    if (std::fabs(centre[axis]) > step) shift[axis] = step * std::nearbyint(centre[axis] / step);
  }
  if (shift.isZero(0)) return;
  state.origin += shift;
  const Vector3<Real> localShift = shift.cast<Real>();
  for (Vector3<Real>& x : state.positions) x -= localShift;
  for (Contact<Real>& contact : state.contacts) contact.anchor -= localShift;
}

template <class Real>
Vector3d FindCentre(const Blueprint& blueprint, const State<Real>& state) {
  return state.origin + AverageByMass(blueprint, state.positions);
}

template <class Real>
Vector3d FindMeanVelocity(const Blueprint& blueprint, const State<Real>& state) {
  return AverageByMass(blueprint, state.velocities);
}

std::uint64_t HashBytes(std::span<const std::byte> bytes, std::uint64_t hash) {
  for (std::size_t i = 0; i + 4 <= bytes.size(); i += 4) {
    std::uint32_t word = 0;
    std::memcpy(&word, &bytes[i], 4);
    hash = (hash ^ word) * 0x100000001B3U;
    hash ^= hash >> 32;
  }
  return hash;
}

template <class Real>
std::uint64_t HashState(const State<Real>& state, std::uint64_t hash) {
  hash = HashBytes(std::as_bytes(std::span(state.origin.data(), 3)), hash);
  for (const Vector3<Real>& x : state.positions) hash = HashBytes(std::as_bytes(std::span(x.data(), 3)), hash);
  for (const Vector3<Real>& v : state.velocities) hash = HashBytes(std::as_bytes(std::span(v.data(), 3)), hash);
  for (std::uint32_t spring = 0; spring < state.torn.size(); ++spring) {
    if (state.torn[spring] != 0) hash = HashBytes(std::as_bytes(std::span(&spring, 1)), hash);
  }
  return hash;
}

#define WOBBLE_INSTANTIATE(Real)                                                            \
  template State<Real> MakeState<Real>(const Blueprint&, const Vector3d&, const Vector3d&); \
  template void PutBackToRest<Real>(const Blueprint&, const Vector3d&, State<Real>&);       \
  template void Recentre<Real>(const Blueprint&, const Vector3d&, State<Real>&);            \
  template Vector3d FindCentre<Real>(const Blueprint&, const State<Real>&);                 \
  template Vector3d FindMeanVelocity<Real>(const Blueprint&, const State<Real>&);           \
  template std::uint64_t HashState<Real>(const State<Real>&, std::uint64_t);
WOBBLE_INSTANTIATE(float)
WOBBLE_INSTANTIATE(double)
#undef WOBBLE_INSTANTIATE

}  // namespace wobble::physics
