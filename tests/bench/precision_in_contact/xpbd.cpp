// A constraint C with compliance α and damping β acts with the force −∇C (C/α + β Ċ). With α̃ = α/h², γ = α β/h, wᵢ the
// inverse masses and multipliers that begin at 0, one visit moves its points along ∇C by
//   Δλ = (−C − γ ∇C·(x − before)) / ((1 + γ) Σ wᵢ|∇ᵢC|² + α̃),   Δxᵢ = wᵢ ∇ᵢC Δλ.
//
//   spring    C = |l| − r, α = 1/k, β = c: the engine's spring and dashpot.
//   gas       not quadratic, so by its tangent: pressure P and −dP/dV = κ at the present volume make C = −P/κ and
//             α = 1/κ, along ∇V.
//   contact   likewise by the tangent of its force N, whose slope N' includes damping: λ = h² N/(1 + h² w N'); friction
//             in the same way, cut to Coulomb's limit.
//
// The usual contact of this method, C = depth without compliance and friction by displacement, is another law; with it
// nothing could be compared.
//
// Where a step is so long that h² k/m is above one, one round does not carry a force through the body: it is softer
// than it should be. As h goes to 0 that vanishes and the equations are those of the engine, to the first order in h.
#include <algorithm>
#include <cmath>

#include "server/physics/methods/forces.h"
#include "tests/bench/precision_in_contact/solvers.h"

namespace wobble::bench {

using namespace physics;

Xpbd::Xpbd(SoftSystem& system) : m_system(system), m_gradient(system.x.size()) {}

void Xpbd::Step(double h) {
  SoftSystem& s = m_system;
  s.before = s.x;
  for (std::size_t i = 0; i < s.x.size(); ++i) {
    if (!(s.inverseMasses[i] > 0)) continue;
    s.v[i] += h * s.Gravity();
    s.x[i] += h * s.v[i];
  }
  for (const SoftSystem::OneBody& body : s.Bodies()) {
    SolveSprings(h, body);
    if (body.blueprint->full.gas > 0) SolveGas(h, body);
  }
  s.FindTouches(m_touches);
  for (const Touch& touch : m_touches) SolveTouch(h, touch);
  for (std::size_t i = 0; i < s.x.size(); ++i) s.v[i] = (s.x[i] - s.before[i]) / h;
  s.EndSubstep(h);
}

void Xpbd::SolveSprings(double h, const SoftSystem::OneBody& body) {
  SoftSystem& s = m_system;
  for (const Spring<double>& spring : body.blueprint->full.springs) {
    const std::size_t a = body.begin + spring.a;
    const std::size_t b = body.begin + spring.b;
    const double mobility = s.inverseMasses[a] + s.inverseMasses[b];
    if (!(spring.stiffness > 0) || !(mobility > 0)) continue;
    const Vector3d l = s.x[a] - s.x[b];
    const double length = l.norm();
    if (!(length > 0)) continue;
    const Vector3d along = l / length;
    const double gamma = spring.damping / (spring.stiffness * h);
    const double motion = along.dot((s.x[a] - s.before[a]) - (s.x[b] - s.before[b]));
    const double lambda =
        (spring.restLength - length - gamma * motion) / ((1 + gamma) * mobility + 1 / (spring.stiffness * h * h));
    s.x[a] += s.inverseMasses[a] * lambda * along;
    s.x[b] -= s.inverseMasses[b] * lambda * along;
  }
}

void Xpbd::SolveGas(double h, const SoftSystem::OneBody& body) {
  SoftSystem& s = m_system;
  const Coefficients<double>& full = body.blueprint->full;
  for (std::size_t i = body.begin; i < body.end; ++i) m_gradient[i].setZero();
  const Vector3d origin = s.x[body.begin];
  double volume = 0;
  for (const Face& face : full.faces) {
    const Vector3d a = s.x[body.begin + face[0]] - origin;
    const Vector3d b = s.x[body.begin + face[1]] - origin;
    const Vector3d c = s.x[body.begin + face[2]] - origin;
    volume += a.dot(b.cross(c)) / 6;
    const Vector3d sixth = (b - a).cross(c - a) / 6;
    for (const std::uint16_t corner : face) m_gradient[body.begin + corner] += sixth;
  }
  const double held = std::max(volume, full.floorVolume);
  const double slope = full.gas / (held * held);
  const double pressure = ComputePressure(full.gas, volume, full.floorVolume) - full.ambientPressure;
  double mobility = 0;
  for (std::size_t i = body.begin; i < body.end; ++i) {
    mobility += s.inverseMasses[i] * m_gradient[i].squaredNorm();
  }
  const double lambda = h * h * pressure / (1 + h * h * slope * mobility);
  for (std::size_t i = body.begin; i < body.end; ++i) s.x[i] += s.inverseMasses[i] * lambda * m_gradient[i];
}

void Xpbd::Move(const Touch& touch, const Vector3d& impulse) {
  for (std::size_t i = 0; i < static_cast<std::size_t>(touch.count); ++i) {
    m_system.x[touch.points[i]] += m_system.inverseMasses[touch.points[i]] * touch.weights[i] * impulse;
  }
}

void Xpbd::SolveTouch(double h, const Touch& touch) {
  double mobility = 0;
  for (std::size_t i = 0; i < static_cast<std::size_t>(touch.count); ++i) {
    mobility += m_system.inverseMasses[touch.points[i]] * touch.weights[i] * touch.weights[i];
  }
  const TouchForce force = m_system.FindForce(touch, h);
  if (!(force.normal > 0)) return;
  const Vector3d normal = force.normal / (1 + h * h * mobility * force.normalSlope) * touch.normal;
  const Vector3d across = force.pull / (1 + h * h * mobility * force.pullSlope);
  Move(touch, h * h * (normal - across));
}

}  // namespace wobble::bench
