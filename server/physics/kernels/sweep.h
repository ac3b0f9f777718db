// One stage of a Runge–Kutta step of W bodies of one blueprint, in one sweep over their vertices: lane l of every
// vector is body l, so all bodies share every index and nothing is gathered or scattered.
//
// At place i the forces from earlier places are already in the ring of pending forces; the springs to later places add
// their force to registers and its opposite to the ring. The gas pushes along the sum of cross products over the
// one-ring, the derivative of the volume; Σ xₖ × xₖ₊₁ round a ring is the sum of xₖ × (xₖ₊₁ − xₖ₋₁) over every other k,
// half as many products. The pressure must be known before the sweep begins: so a stage sums the volume of the
// positions that it writes, two faces at a time, as soon as their last vertex is written.
//
// The step is the classic tableau in increments, runge_kutta.h, for x'' = a(x, v): stage s reads its positions and
// velocities from one array and writes those of stage s + 1 into another.
#pragma once

#include <cstdint>

#include "server/physics/kernels/contact/body_contact_lanes.h"
#include "server/physics/kernels/contact/contact_lanes.h"
#include "server/physics/kernels/contact/plane_lanes.h"
#include "server/physics/kernels/contact/point_lanes.h"
#include "server/physics/kernels/grid.h"
#include "server/physics/kernels/sweep_tables.h"

namespace wobble::physics {

// The arrays of the bodies in a pack: [place][k][lane] for k numbers a vertex, [lane] for one number a body, aligned to
// a whole vector. A grid has rows for places and columns for lanes (grid.h).
template <class Real>
struct SweepLanes {
  Real* state = nullptr;       // x y z vx vy vz at the beginning of the step, and at its end
  Real* stage = nullptr;       // the same for the stage that is computed; the first stage reads `state`
  Real* nextStage = nullptr;   // for the stage after it; the two are exchanged after each sweep
  Real* increments = nullptr;  // of the step so far; after the last stage its first three are that stage's acceleration
  Real* pending = nullptr;     // [pendingMask + 1][3][lane], N, all zero between sweeps; in a grid see GridDirection
  const Real* outer = nullptr;             // [place][3][lane]: forces that the sweep does not compute, N; null: none
  const std::uint8_t* hasOuter = nullptr;  // [place]: not 0 if a lane has such a force
  const Real* acceleration = nullptr;      // [3][lane]: gravity and the like, m/s²
  const Real* wind = nullptr;              // [3][lane], m/s; only for bodies with drag
  const Real* whole = nullptr;             // [arc][lane]: 0 if the spring has torn, else 1; null: springs do not tear
  const Real* gas = nullptr;               // nRT, J
  const Real* stiffnessFactors = nullptr;  // factor on every spring's stiffness and damping
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
  // Writes `sixVolume` of the positions in `state`, before the first stage.
  void (*computeVolume)(const SweepTables<Real>& tables, SweepLanes<Real>& lanes) = nullptr;
  ContactKernel<Real> computeContacts = nullptr;
  BodyContactKernel<Real> bodyContacts;
  GridSweep<Real> gridStages[4] = {};
  PointKernel<Real> points;
  PlaneKernel<Real> planes;
};

}  // namespace wobble::physics
