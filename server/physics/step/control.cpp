// Moving accelerates the body towards the velocity that is asked for, in proportion to what is missing of it, so that
// it neither overshoots nor jerks. Gas and stiffness follow their keys over a few ticks for the reason at
// kFactorApproach.
#include "server/physics/step/control.h"

#include <algorithm>

namespace wobble::physics {
namespace {

// Share of the remaining way that the gas and stiffness factors go each tick: 95 % in 0.1 s at 60 Hz. Slow enough that
// the change of energy acts as the player's work and not as a shock.
constexpr double kFactorApproach = 0.4;

// Missing speed from which on a body that moves gets the full acceleration, as a share of the top speed. Below, the
// acceleration is proportional to it.
constexpr double kSpeedBand = 0.25;

// Horizontal acceleration towards the velocity that is asked for, m/s².
Vector3d FindMoveAcceleration(const Control& control, const ControlLimits& limits, const Vector3d& velocity) {
  const Vector3d wanted(control.moveX, control.moveY, 0);
  if (!(limits.speed > 0)) return Vector3d::Zero();
  Vector3d missing = wanted * limits.speed - velocity;
  missing.z() = 0;
  const Vector3d share = missing / (kSpeedBand * limits.speed);
  return limits.acceleration * share / std::max(1.0, share.norm());
}

template <class Real>
bool IsTouching(const State<Real>& state) {
  return std::any_of(state.contacts.begin(), state.contacts.end(), [](const Contact<Real>& c) { return c.touching; });
}

}  // namespace

template <class Real>
Load<Real> ApplyControl(const Blueprint& blueprint, const Vector3d& gravity, const StiffnessRule& stiffness, Body& body,
                        State<Real>& state) {
  const Control& control = body.control;
  const ControlLimits& limits = body.limits;
  if (control.jump && !body.jumpHeld && (body.touchesBody || IsTouching(state))) {
    for (Vector3<Real>& v : state.velocities) v.z() += static_cast<Real>(limits.jumpSpeed);
    for (const std::uint16_t vertex : blueprint.full.fixed) state.velocities[vertex].setZero();
  }
  body.jumpHeld = control.jump;
  body.gasFactor += kFactorApproach * ((control.puff ? limits.puffFactor : 1.0) - body.gasFactor);
  const double wanted = stiffness.Find(control.stiffen ? limits.stiffenFactor : 1.0);
  body.stiffnessFactor += kFactorApproach * (wanted - body.stiffnessFactor);

  Load<Real> load;
  // A body that is not asked to move is left to friction instead of being braked to a speed of 0.
  const bool moves = control.moveX != 0 || control.moveY != 0;
  const Vector3d push =
      moves ? FindMoveAcceleration(control, limits, FindMeanVelocity(blueprint, state)) : Vector3d(Vector3d::Zero());
  load.acceleration = (gravity + push).cast<Real>();
  load.gasFactor = static_cast<Real>(body.gasFactor);
  load.stiffnessFactor = static_cast<Real>(body.stiffnessFactor);
  load.torn = state.torn;
  return load;
}

template Load<float> ApplyControl<float>(const Blueprint&, const Vector3d&, const StiffnessRule&, Body&, State<float>&);
template Load<double> ApplyControl<double>(const Blueprint&, const Vector3d&, const StiffnessRule&, Body&,
                                           State<double>&);

}  // namespace wobble::physics
