// One stage of a Runge–Kutta step of W bodies of one blueprint, in one sweep over their vertices: lane l of every
// vector is body l, so every index is shared and nothing is gathered or scattered.
//
// At place i the forces from places before it are already in the pending ring; the springs to places further on add
// theirs to registers and pass the opposite on. The gas pushes along the sum of cross products over the one-ring, the
// derivative of the volume; Σ xₖ × xₖ₊₁ round a ring is the sum of xₖ × (xₖ₊₁ − xₖ₋₁) over every other k, half as many.
// Its pressure must be known before the sweep begins: the volume of the positions that a stage leaves behind is summed
// while they are written, two faces at a time, as soon as their last vertex is.
//
// The step is the classic tableau in increments, runge_kutta.h, for x'' = a(x, v): stage s reads its positions and
// velocities from one array and writes those of stage s + 1 into another.
#pragma once

#include <cstdint>

#include "server/physics/lanes/body_contact_lanes.h"
#include "server/physics/lanes/contact_lanes.h"
#include "server/physics/lanes/grid.h"
#include "server/physics/lanes/plane_lanes.h"
#include "server/physics/lanes/point_lanes.h"
#include "server/physics/lanes/sweep_tables.h"

namespace wobble::physics {

// Of the bodies in a pack. [place][k][lane] where an array has several numbers a vertex, [lane] where it has one a
// body; aligned to a whole vector.
template <class Real>
struct SweepLanes {
  Real* state = nullptr;       // x y z vx vy vz at the beginning of the step, and at its end
  Real* stage = nullptr;       // of the stage that is computed, but for the first
  Real* nextStage = nullptr;   // the two change places after each sweep
  Real* increments = nullptr;  // of the step so far; after the last stage its first three are that stage's acceleration
  Real* pending = nullptr;     // [pendingMask + 1][3][lane], N, all 0 between sweeps
  const Real* outer = nullptr;             // [place][3][lane]: all further forces, N; null: none
  const std::uint8_t* hasOuter = nullptr;  // [place]: not 0 where a lane has one
  const Real* acceleration = nullptr;      // [3][lane]: gravity and the like, m/s²
  const Real* wind = nullptr;              // [3][lane], where bodies drag, m/s
  const Real* whole = nullptr;             // [arc][lane], 0 where a spring has torn, else 1; null: they do not tear
  const Real* gas = nullptr;               // J
  const Real* stiffnessFactors = nullptr;  // times every spring's stiffness and damping
  Real* sixVolume = nullptr;               // 6 V of the stage's positions, m³; in an outline twice the area, m²
  Real* velocityErrors = nullptr;          // last stage: Σ |v₄ − v_new|², m²/s²
  Real* accelerationErrors = nullptr;      // first stage: Σ |a₄ of the step before − a₁|², m²/s⁴
};

template <class Real>
using Sweep = void (*)(const SweepTables<Real>& tables, SweepLanes<Real>& lanes, Real step);

template <class Real>
using GridSweep = void (*)(const GridTables<Real>& tables, SweepLanes<Real>& lanes, Real step);

// The sweeps of one instruction set and width.
template <class Real>
struct SweepKernel {
  int width = 0;
  Sweep<Real> stages[4] = {};
  void (*computeVolume)(const SweepTables<Real>& tables, SweepLanes<Real>& lanes) = nullptr;  // of `state`
  ContactKernel<Real> computeContacts = nullptr;
  BodyContactKernel<Real> bodyContacts;
  GridSweep<Real> gridStages[4] = {};
  PointKernel<Real> points;
  PlaneKernel<Real> planes;
};

}  // namespace wobble::physics
