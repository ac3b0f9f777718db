// A step of implicit Euler lowers G(x) = Σ mᵢ|xᵢ − aimᵢ|²/2h² + E(x), with aim = x + h v + h² g and E the potential of
// all forces, dashpots counted by the motion of the step. One visit of a vertex solves (m/h² + ∂²E/∂xᵢ²) Δx = −∂G/∂xᵢ.
//
//   spring    curvature k [d dᵀ + max(0, 1 − r/l)(1 − d dᵀ)] + c/h d dᵀ, kept positive for compressed springs.
//   gas       the volume is linear in any one vertex, so it is kept up to date as each moves: force P ∂V/∂xᵢ, curvature
//             κ ∂V/∂xᵢ ∂V/∂xᵢᵀ with κ = −dP/dV.
//   contact   faces, normals and weights are looked up once a round; depth and force follow each move.
//
// With few rounds, or long steps, the energy is not at its lowest when the step ends, and the rest of it is lost: the
// method is stable at any step, and the error is then that of the rounds. With short steps it is that of implicit
// Euler.
#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "server/physics/methods/forces.h"
#include "tests/bench/precision_in_contact/solvers.h"

namespace wobble::bench {

using namespace physics;

BlockDescent::BlockDescent(SoftSystem& system) : m_system(system), m_touchesOf(system.x.size()), m_aim(system.x) {
  std::vector<std::vector<HalfSpring>> of(system.x.size());
  for (const SoftSystem::OneBody& body : system.Bodies()) {
    for (const Spring<double>& spring : body.blueprint->full.springs) {
      const auto a = static_cast<std::uint32_t>(body.begin + spring.a);
      const auto b = static_cast<std::uint32_t>(body.begin + spring.b);
      of[a].push_back({b, spring.restLength, spring.stiffness, spring.damping});
      of[b].push_back({a, spring.restLength, spring.stiffness, spring.damping});
    }
  }
  for (const std::vector<HalfSpring>& each : of) {
    m_springBegin.push_back(m_springs.size());
    m_springs.insert(m_springs.end(), each.begin(), each.end());
  }
  m_springBegin.push_back(m_springs.size());
}

void BlockDescent::Step(double h, int rounds) {
  SoftSystem& s = m_system;
  s.before = s.x;
  for (std::size_t i = 0; i < s.x.size(); ++i) {
    if (s.inverseMasses[i] > 0) s.x[i] += h * (s.v[i] + h * s.Gravity());
    m_aim[i] = s.x[i];
  }
  for (int round = 0; round < rounds; ++round) {
    ListTouches();
    for (const SoftSystem::OneBody& body : s.Bodies()) DescendBody(h, body);
  }
  for (std::size_t i = 0; i < s.x.size(); ++i) s.v[i] = (s.x[i] - s.before[i]) / h;
  s.EndSubstep(h);
}

void BlockDescent::ListTouches() {
  for (const Touch& touch : m_touches) {
    for (std::size_t i = 0; i < static_cast<std::size_t>(touch.count); ++i) m_touchesOf[touch.points[i]].clear();
  }
  m_system.FindTouches(m_touches);
  for (std::uint32_t t = 0; t < m_touches.size(); ++t) {
    for (std::uint32_t i = 0; i < static_cast<std::uint32_t>(m_touches[t].count); ++i) {
      m_touchesOf[m_touches[t].points[i]].push_back({t, i});
    }
  }
}

void BlockDescent::DescendBody(double h, const SoftSystem::OneBody& body) {
  SoftSystem& s = m_system;
  const Coefficients<double>& full = body.blueprint->full;
  const Topology& topology = body.blueprint->topology;
  const bool hasGas = full.gas > 0;
  double volume = 0;
  if (hasGas) volume = ComputeVolume<double>(full.faces, std::span(s.x).subspan(body.begin, body.end - body.begin));
  for (std::size_t i = body.begin; i < body.end; ++i) {
    if (!(s.inverseMasses[i] > 0)) continue;
    const double inertia = 1 / (s.inverseMasses[i] * h * h);
    Block block;
    block.force = inertia * (m_aim[i] - s.x[i]);
    block.stiffness = inertia * Eigen::Matrix3d::Identity();
    AddSprings(h, i, block);
    AddTouches(h, i, block);
    Vector3d growth = Vector3d::Zero();  // ∂V/∂xᵢ, m²
    if (hasGas) {
      for (const std::uint16_t f : topology.RingOf(static_cast<std::uint16_t>(i - body.begin))) {
        const Vector3d& a = s.x[body.begin + full.faces[f][0]];
        growth += (s.x[body.begin + full.faces[f][1]] - a).cross(s.x[body.begin + full.faces[f][2]] - a) / 6;
      }
      const double held = std::max(volume, full.floorVolume);
      block.force += (ComputePressure(full.gas, volume, full.floorVolume) - full.ambientPressure) * growth;
      block.stiffness += full.gas / (held * held) * growth * growth.transpose();
    }
    const Vector3d move = block.stiffness.inverse() * block.force;
    s.x[i] += move;
    volume += growth.dot(move);
  }
}

void BlockDescent::AddSprings(double h, std::size_t vertex, Block& block) const {
  const SoftSystem& s = m_system;
  const Vector3d motion = s.x[vertex] - s.before[vertex];
  for (std::size_t i = m_springBegin[vertex]; i < m_springBegin[vertex + 1]; ++i) {
    const HalfSpring& spring = m_springs[i];
    const Vector3d l = s.x[vertex] - s.x[spring.other];
    const double length = l.norm();
    if (!(length > 0)) continue;
    const Vector3d along = l / length;
    const double rate = along.dot(motion - (s.x[spring.other] - s.before[spring.other])) / h;
    block.force -= (spring.stiffness * (length - spring.restLength) + spring.damping * rate) * along;
    const double sideways = spring.stiffness * std::max(0.0, 1 - spring.restLength / length);
    block.stiffness.diagonal().array() += sideways;
    block.stiffness += (spring.stiffness + spring.damping / h - sideways) * along * along.transpose();
  }
}

void BlockDescent::AddTouches(double h, std::size_t vertex, Block& block) const {
  for (const HalfTouch& half : m_touchesOf[vertex]) {
    const Touch& touch = m_touches[half.touch];
    const TouchForce force = m_system.FindForce(touch, h);
    if (!(force.normal > 0)) continue;
    const double weight = touch.weights[half.place];
    block.force += weight * (force.normal * touch.normal - force.pull);
    const Eigen::Matrix3d along = touch.normal * touch.normal.transpose();
    block.stiffness +=
        weight * weight * (force.normalSlope * along + force.pullSlope * (Eigen::Matrix3d::Identity() - along));
  }
}

}  // namespace wobble::bench
