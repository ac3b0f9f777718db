// Gas: M v' = −c g (g·v) with g = ∂V/∂x of all coordinates has the solution v − M⁻¹g (g·v)/γ (1 − e^{−cγT}), where
// γ = g·M⁻¹g. e^z is taken as 1 + z + z²/2 + z³/6 + z⁴/24, whose bits no library decides and which never gains energy
// either. Rolling: implicit Euler for J ω' = −κ ω, that is (J + κT) Δω = −κT ω.
//
// A vertex is a row (vertex_rows.h), of which the fourth number is 0: with a vector's three numbers one by one a ball
// of 162 vertices took four times as long.
#include "server/physics/step/losses.h"

#include "server/physics/contact/contact.h"
#include "server/physics/lanes/lanes.h"
#include "server/physics/lanes/vertex_rows.h"
#include "server/physics/model/survey.h"

namespace wobble::physics {
namespace {

template <class Real>
using RowOf = typename RowsOf<Real>::Row;

template <class Real>
RowOf<Real> MakeRow(const Vector3<Real>& v) {
  return RowOf<Real>{v.x(), v.y(), v.z(), Real(0)};
}

template <class Real>
void AddToVector(RowOf<Real> row, Vector3<Real>& v) {
  v.x() += row[0];
  v.y() += row[1];
  v.z() += row[2];
}

// A row of which the Turn is a × b.
template <class Row>
Row FindUnturnedCross(Row a, Row b) {
  return Fms(a, Turn(b), Turn(a) * b);
}

template <class Row>
double SumRow(Row row) {
  return double{row[0]} + double{row[1]} + double{row[2]};
}

// Fills in the rows of ∂V/∂xᵢ, m²: a third of the area vectors of the faces around vertex i. Planar: of the area, m.
template <class Real>
void FindVolumeGradient(const Coefficients<Real>& body, std::span<const Vector3<Real>> x, std::vector<Real>& gradient) {
  using Row = RowOf<Real>;
  gradient.assign(8 * x.size(), Real(0));  // positions come behind
  Real* const g = gradient.data();
  for (const auto& [a, b] : body.outline) {
    const Vector3<Real> along = (x[b] - x[a]) / Real(2);
    const Row outward{along.z(), Real(0), -along.x(), Real(0)};
    StoreRow(LoadRow(g + 4 * a) + outward, g + 4 * a);
    StoreRow(LoadRow(g + 4 * b) + outward, g + 4 * b);
  }
  if (!body.outline.empty()) return;
  Real* const rows = g + 4 * x.size();
  for (std::size_t i = 0; i < x.size(); ++i) StoreRow(MakeRow<Real>(x[i]), rows + 4 * i);
  for (const auto& [i, j, k] : body.faces) {
    const Row corner = LoadRow(rows + 4 * i);
    const Row unturned = FindUnturnedCross(LoadRow(rows + 4 * j) - corner, LoadRow(rows + 4 * k) - corner);
    StoreRow(LoadRow(g + 4 * i) + unturned, g + 4 * i);
    StoreRow(LoadRow(g + 4 * j) + unturned, g + 4 * j);
    StoreRow(LoadRow(g + 4 * k) + unturned, g + 4 * k);
  }
  const Row sixth = Spread<Row>(Real(1) / Real(6));
  for (std::size_t i = 0; i < x.size(); ++i) StoreRow(Turn(LoadRow(g + 4 * i)) * sixth, g + 4 * i);
}

template <class Real>
void LoseInGas(const Blueprint& blueprint, double duration, std::vector<Real>& gradient, State<Real>& state) {
  using Row = RowOf<Real>;
  const Coefficients<Real>& body = blueprint.Read<Real>();
  FindVolumeGradient<Real>(body, state.positions, gradient);
  Row rates = Spread<Row>(Real(0));
  Row perMass = rates;
  for (std::size_t i = 0; i < state.velocities.size(); ++i) {
    const Row g = LoadRow(&gradient[4 * i]);
    rates = Fma(g, MakeRow<Real>(state.velocities[i]), rates);
    perMass = Fma(g * Spread<Row>(body.inverseMasses[i]), g, perMass);
  }
  const double gamma = SumRow(perMass);
  if (!(gamma > 0)) return;
  const double z = blueprint.gasViscosity * gamma * duration;
  const double lost = 1 - 1 / (1 + z * (1 + z / 2 * (1 + z / 3 * (1 + z / 4))));
  const auto impulse = static_cast<Real>(-lost * SumRow(rates) / gamma);  // of the pressure, Pa·s
  for (std::size_t i = 0; i < state.velocities.size(); ++i) {
    AddToVector<Real>(LoadRow(&gradient[4 * i]) * Spread<Row>(impulse * body.inverseMasses[i]), state.velocities[i]);
  }
}

// The normal force by which static surfaces carry the body, N, without damping.
template <class Real>
double FindCarriedWeight(const Coefficients<Real>& body, std::span<const Surface<Real>> surfaces,
                         const State<Real>& state) {
  double sum = 0;
  for (const Contact<Real>& contact : state.contacts) {
    if (!contact.touching) continue;
    const auto point = FindContactPoint(surfaces[contact.surface], contact, state.positions[contact.vertex]);
    sum += double{body.contactShares[contact.vertex] * ComputePenalty(body.contact, -point.distance)};
  }
  return sum;
}

// A symmetric matrix by its six numbers.
struct Inertia {
  double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;  // kg m²

  [[nodiscard]] double Mean() const { return (xx + yy + zz) / 3; }
  // Solves (this + `added` times the identity) · answer = right, by Cramer's rule; it must be positive definite.
  [[nodiscard]] Vector3d Solve(double added, const Vector3d& right) const {
    const Vector3d a(xx + added, xy, xz), b(xy, yy + added, yz), c(xz, yz, zz + added);
    const Vector3d bc = b.cross(c);
    return Vector3d(right.dot(bc), a.dot(right.cross(c)), a.dot(b.cross(right))) / a.dot(bc);
  }
};

// Angular momentum about the centre, kg m²/s, and inertia.
template <class Real>
void FindSpin(const Coefficients<Real>& body, const BulkMotion& bulk, const State<Real>& state, Vector3d& spin,
              Inertia& inertia) {
  using Row = RowOf<Real>;
  const Row centre = MakeRow<Real>(bulk.centre.cast<Real>());
  const Row velocity = MakeRow<Real>(bulk.velocity.cast<Real>());
  Row unturned = Spread<Row>(Real(0));  // of the angular momentum
  Row squares = unturned;
  Row products = unturned;  // xy, yz, zx
  for (std::size_t i = 0; i < body.masses.size(); ++i) {
    const Row mass = Spread<Row>(body.masses[i]);
    const Row r = MakeRow<Real>(state.positions[i]) - centre;
    const Row moment = r * mass;
    unturned = unturned + FindUnturnedCross(moment, MakeRow<Real>(state.velocities[i]) - velocity);
    squares = Fma(moment, r, squares);
    products = Fma(moment, Turn(r), products);
  }
  const Row momentum = Turn(unturned);
  spin = Vector3d(double{momentum[0]}, double{momentum[1]}, double{momentum[2]});
  const double x = double{squares[0]}, y = double{squares[1]}, z = double{squares[2]};
  inertia = {.xx = y + z,
             .yy = x + z,
             .zz = x + y,
             .xy = -double{products[0]},
             .xz = -double{products[2]},
             .yz = -double{products[1]}};
}

template <class Real>
void LoseInRolling(const Blueprint& blueprint, double normalForce, double duration, State<Real>& state) {
  using Row = RowOf<Real>;
  const Coefficients<Real>& body = blueprint.Read<Real>();
  const BulkMotion bulk = FindBulkMotion<Real>(body.masses, state.positions, state.velocities);
  Vector3d spin;
  Inertia inertia;
  FindSpin(body, bulk, state, spin, inertia);
  const double mean = inertia.Mean();
  if (!(mean > 0)) return;  // a single particle
  // The small addition makes the inertia of a rod, which has none about its axis, regular.
  const Vector3d turn = inertia.Solve(1e-6 * mean, spin);
  const double friction = double{body.contact.rollingResistance} * normalForce * blueprint.size /
                          (turn.norm() + kRollingSpeed / blueprint.size);
  const Vector3d change = inertia.Solve(friction * duration, -friction * duration * turn);
  const Row turning = MakeRow<Real>(change.cast<Real>());
  const Row centre = MakeRow<Real>(bulk.centre.cast<Real>());
  for (std::size_t i = 0; i < body.masses.size(); ++i) {
    const Row r = MakeRow<Real>(state.positions[i]) - centre;
    AddToVector<Real>(Turn(FindUnturnedCross(turning, r)), state.velocities[i]);
  }
}

}  // namespace

template <class Real>
void ApplyLosses(const Blueprint& blueprint, std::span<const Surface<Real>> surfaces, double duration,
                 std::vector<Real>& scratch, State<Real>& state) {
  if (blueprint.gasViscosity > 0) LoseInGas<Real>(blueprint, duration, scratch, state);
  const Coefficients<Real>& body = blueprint.Read<Real>();
  if (!(body.contact.rollingResistance > Real(0)) || body.contact.law != ContactLaw::kPenalty || !body.fixed.empty()) {
    return;
  }
  const double normalForce = FindCarriedWeight<Real>(body, surfaces, state);
  if (normalForce > 0) LoseInRolling<Real>(blueprint, normalForce, duration, state);
}

template void ApplyLosses<float>(const Blueprint&, std::span<const Surface<float>>, double, std::vector<float>&,
                                 State<float>&);
template void ApplyLosses<double>(const Blueprint&, std::span<const Surface<double>>, double, std::vector<double>&,
                                  State<double>&);

}  // namespace wobble::physics
