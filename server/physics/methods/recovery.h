// What brings a body back that has lost its shape: the cells of a lattice by themselves (unfolding.h), and an aim for
// the rest shape, as follows.
//
// Springs know lengths, elements volumes, and gas knows one volume, so there are states at rest far from the rest
// shape: a ring that is wound twice or everted, a lattice whose corners hold one another, elements that go round an
// edge twice. No force at a single place finds the way out of all of them: in a plane a loop leaves a smooth curve
// through a cusp alone (Whitney 1937, "On regular closed curves in the plane"). So every vertex is drawn to its place
// in the rest shape, laid over the body as it fits best (shape matching: Müller, Heidelberger, Teschner & Gross 2005,
// "Meshless deformations based on shape matching", here as a force in the equations of motion):
//   E = ½ κ Σ mᵢ |dᵢ|²,   dᵢ = xᵢ − c − R rᵢ,   force −κ mᵢ dᵢ,
// c the centre of mass, rᵢ the places at rest about theirs, and R the rotation for which E is least: the one nearest to
// Σ mᵢ (xᵢ − c) rᵢᵀ. Since Σ mᵢ rᵢ = 0 the forces sum up to zero, and since E does not change with R to first order, so
// do their torques. Motion is damped at the rate γ but for what is rigid in it. The aim begins when the body has been
// out of shape for a while, and grows: in play one that is hit may fold for some ticks, and its own forces open it.
// A ball has an aim for the case alone that it was inside out (ShapeAim::afterInsideOut): a dent under load is a shape
// of its own, and the gas opens it. The damping matters there as much as the force: in a ball without damping the heat
// of a fall may exceed the energy of its gas, which then goes in and out through itself.
//
// Rejected: to bend the sharpest corner of a ring until it is a cusp, which frees rings of one layer alone and three in
// 10,000 not; the law of unfolding.h for the cells of rings, which leaves a ring of several layers wound twice.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "server/physics/methods/forces.h"
#include "server/physics/model/blueprint.h"
#include "server/physics/model/vector.h"

namespace wobble::physics {

// How often a closed outline goes round, counter-clockwise as seen from −y: its direction turns by 2π times this
// number. A corner of exactly π counts as turning either way.
template <class Real>
[[nodiscard]] int FindTurningNumber(std::span<const std::array<std::uint16_t, 2>> outline,
                                    std::span<const Vector3<Real>> x);

// Whether a body with cells or an aim is in a state that its other forces may not leave:
//   lattice  a corner of a cell is thinner than kFoldStretch;
//   solid    an element is inside out, or elements go round one of their vertices twice;
//   ring     its outline does not go round once, or a face between its layers is inside out;
//   shell    a face looks towards the centre, or the skin goes round it twice: only of those where none does at rest.
// Always false of other bodies.
template <class Real>
[[nodiscard]] bool HasLostShape(const Coefficients<Real>& body, std::span<const Vector3<Real>> x);

// time: of the world, s. lost: for how long the body has been out of shape, s. stiffnessFactor: of its springs.
template <class Real>
[[nodiscard]] RecoveryFactors FindRecoveryFactors(const Coefficients<Real>& body, double time, double lost,
                                                  double stiffnessFactor);

// The factor, at most 1, on the stiffness of a solid whose elements are stretched so far that kMaxSubsteps do not hold
// them: they give way as far as needed. Of a body that has lost its shape they give way twice as far, to leave room for
// the aim. tick: s.
[[nodiscard]] double FindSoftening(const Blueprint& blueprint, const Stiffening& stiffening, bool hasLostShape,
                                   double tick);

// Adds the forces, elastic and damping; the factors multiply the elastic ones.
template <class Real>
void AddRecovery(const Coefficients<Real>& body, const RecoveryFactors& factors, std::span<const Vector3<Real>> x,
                 std::span<const Vector3<Real>> v, std::span<Vector3<Real>> forces);

// The energy that they store, J.
[[nodiscard]] double ComputeRecoveryEnergy(const Coefficients<double>& body, const RecoveryFactors& factors,
                                           std::span<const Vector3d> x);

}  // namespace wobble::physics
