// Explicit Runge–Kutta steps of x'' = a(x, v), from a Butcher tableau, in increment form.
//
// With k_x,i = v + h Σ aᵢⱼ k_v,j and k_v,i = a(x + h Σ aᵢⱼ k_x,j, k_x,i), the increments Δx = h Σ bᵢ k_x,i and
// Δv = h Σ bᵢ k_v,i are summed first and added once. Rejected: writing the new state as a combination of stages. It
// saves the k arrays for the classic tableau but loses bits in single precision: it moves a quarter of all resting
// coordinates each step.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "server/physics/model/vector.h"

namespace wobble::physics {

// Row i of `a` holds the weights of the stages before i. The sum of a row is the time of the stage, which autonomous
// forces do not need.
template <std::size_t Stages>
struct ButcherTableau {
  std::array<std::array<double, Stages>, Stages> a{};
  std::array<double, Stages> b{};
};

// The classic Runge–Kutta method (Kutta 1901), order 4.
inline constexpr ButcherTableau<4> kClassicRungeKutta{
    .a = {{{0, 0, 0, 0}, {0.5, 0, 0, 0}, {0, 0.5, 0, 0}, {0, 0, 1, 0}}}, .b = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6}};

// Scratch of a step, one entry a vertex, reused from body to body.
template <class Real, std::size_t Stages>
struct StageBuffers {
  std::array<std::vector<Vector3<Real>>, Stages> velocities;     // k_x
  std::array<std::vector<Vector3<Real>>, Stages> accelerations;  // k_v
  std::vector<Vector3<Real>> positions;

  void Reserve(std::size_t vertices) {
    for (auto& k : velocities) k.reserve(vertices);
    for (auto& k : accelerations) k.reserve(vertices);
    positions.reserve(vertices);
  }
  void Resize(std::size_t vertices) {
    for (auto& k : velocities) k.resize(vertices);
    for (auto& k : accelerations) k.resize(vertices);
    positions.resize(vertices);
  }
};

// Fills in positions and velocities of a stage, for vertices from `begin` up to `end`, from the stages before it.
template <class Real, std::size_t Stages>
void CombineStage(const ButcherTableau<Stages>& tableau, std::size_t stage, Real h, std::span<const Vector3<Real>> x,
                  std::span<const Vector3<Real>> v, std::size_t begin, std::size_t end,
                  StageBuffers<Real, Stages>& buffers) {
  for (std::size_t i = begin; i < end; ++i) {
    Vector3<Real> stepX = Vector3<Real>::Zero();
    Vector3<Real> stepV = Vector3<Real>::Zero();
    for (std::size_t j = 0; j < stage; ++j) {
      if (tableau.a[stage][j] == 0) continue;
      const Real weight = h * static_cast<Real>(tableau.a[stage][j]);
      stepX += weight * buffers.velocities[j][i];
      stepV += weight * buffers.accelerations[j][i];
    }
    buffers.positions[i] = x[i] + stepX;
    buffers.velocities[stage][i] = v[i] + stepV;
  }
}

// Adds the increments to x and v of these vertices, once the accelerations of all stages are known.
template <class Real, std::size_t Stages>
void AddIncrements(const ButcherTableau<Stages>& tableau, Real h, std::size_t begin, std::size_t end,
                   const StageBuffers<Real, Stages>& buffers, std::span<Vector3<Real>> x, std::span<Vector3<Real>> v) {
  for (std::size_t i = begin; i < end; ++i) {
    Vector3<Real> incrementX = Vector3<Real>::Zero();
    Vector3<Real> incrementV = Vector3<Real>::Zero();
    for (std::size_t stage = 0; stage < Stages; ++stage) {
      const Real weight = h * static_cast<Real>(tableau.b[stage]);
      incrementX += weight * buffers.velocities[stage][i];
      incrementV += weight * buffers.accelerations[stage][i];
    }
    x[i] += incrementX;
    v[i] += incrementV;
  }
}

// One step of h s. accelerate(x, v, a) fills in a, m/s², from spans of positions and velocities.
template <class Real, std::size_t Stages, class Accelerate>
void StepRungeKutta(const ButcherTableau<Stages>& tableau, Real h, Accelerate&& accelerate, std::span<Vector3<Real>> x,
                    std::span<Vector3<Real>> v, StageBuffers<Real, Stages>& buffers) {
  buffers.Resize(x.size());
  for (std::size_t stage = 0; stage < Stages; ++stage) {
    CombineStage<Real>(tableau, stage, h, x, v, 0, x.size(), buffers);
    accelerate(std::span<const Vector3<Real>>(buffers.positions),
               std::span<const Vector3<Real>>(buffers.velocities[stage]),
               std::span<Vector3<Real>>(buffers.accelerations[stage]));
  }
  AddIncrements<Real>(tableau, h, 0, x.size(), buffers, x, v);
}

}  // namespace wobble::physics
