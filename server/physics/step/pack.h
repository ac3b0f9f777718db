// Bodies of one blueprint side by side, a lane each, for the sweeps of lanes/sweep.h.
//
// The bodies' own states stay as they are, one vertex behind the other: a pack is filled from them for a try of a tick
// and read back after it, which costs a few nanoseconds a vertex and leaves nothing to be kept in step when bodies
// wake, touch or change. Forces from outside the sweep (contacts, pushes) are found before each stage, at its
// positions, and wait for it in an array of their own. What a body does depends on nothing that the others of its pack
// do.
//
// A body that stands in a grid and is one of few fills a pack by itself, row by row (lanes/grid.h).
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <vector>

#include "server/physics/lanes/kernels.h"
#include "server/physics/step/body_system.h"
#include "server/physics/step/pack_contacts.h"
#include "server/physics/step/pack_planes.h"

namespace wobble::physics {

// Reused from pack to pack.
template <class Real>
struct PackScratch {
  struct alignas(64) Line {
    std::array<std::byte, 64> bytes;
  };
  std::vector<Line> lines;                 // all that the sweep works on
  std::vector<std::uint8_t> hasOuter;      // SweepLanes
  std::vector<std::uint32_t> outerPlaces;  // those
  GridRows<Real> tornRows;                 // of a body by rows that has torn
  // Of one body, with what contacts read and write.
  std::vector<Vector3<Real>> positions;
  std::vector<Vector3<Real>> velocities;
  std::vector<Vector3<Real>> forces;
  PackPlanes<Real> planes;
  PackContacts<Real> contacts;

  // For a pack of bodies of so many vertices.
  void Reserve(std::size_t vertices);
};

// Whether a body of this kind, of so many together, is stepped by itself, row by row, rather than in a lane of a pack.
// It comes to the same bits, but for rare terms (lanes/rare_terms.h), which add up in another order: a kind that has
// some goes one way always.
template <class Real>
[[nodiscard]] bool GoesByRows(const Blueprint& blueprint, std::size_t bodies);

// Whether springs of the body have torn that by its blueprint cannot. The sweep of rare terms leaves them out, which is
// not the one that others of its kind go through.
template <class Real>
[[nodiscard]] bool IsCut(const Member<Real>& member) {
  return !member.load.torn.empty() && !member.blueprint->template ReadPlan<Real>().tears;
}

template <class Real>
class Pack {
 public:
  // whose: members of the system, by their places there, all of one blueprint and all cut or none; at most as many as
  // the widest kernel has lanes, and by rows one. Filled from their states.
  Pack(const BodySystem<Real>& system, std::span<const std::uint32_t> whose, bool byRows,
       std::span<const SweepKernel<Real>> kernels, PackScratch<Real>& scratch);

  // The four stages of a step of h s, each in two islands: first the forces of what stands still and of pushes, to
  // which others may be added, then the sweep.
  void BeginStage(int stage);
  // Of BeginStage's positions; vertex: of the body that is whose[lane].
  void AddOuterForce(std::size_t lane, std::size_t vertex, const Vector3<Real>& force) {
    AddToSeat(FindSeat(lane, vertex), force);
  }
  void Sweep(int stage, Real h);
  // After the fourth: static contacts follow. timeLeft: of the tick, s, when the step began. isFirst: of the tick.
  void EndStep(double step, double timeLeft, bool isFirst);

  // After the last step: everything to the island's arrays and members.
  void EndTry() const;

  // Positions and velocities at which `stage` will be swept to the island's arrays; after the fourth: stage 0.
  void CopyToSystem(int stage) const;

  [[nodiscard]] std::span<const std::uint32_t> Whose() const { return m_whose; }

 private:
  using Member = physics::Member<Real>;

  void LayOut();
  void LoadBodies();
  void LoadContacts();
  void LoadVertices();
  void LoadRows();
  void LeaveTornOut();
  void CopyRowsToSystem(int stage) const;
  void AddPlaneForces(const Real* from);
  void AddUnbulkedForces(std::size_t lane, const Real* from);
  void AddToSeat(const PackSeat& seat, const Vector3<Real>& force) {
    Real* at = m_outer + 3 * seat.place * m_width;
    if (m_scratch.hasOuter[seat.place] == 0) {
      std::fill_n(at, 3 * m_width, Real(0));
      m_scratch.hasOuter[seat.place] = 1;
      m_scratch.outerPlaces.push_back(seat.place);
    }
    for (std::size_t k = 0; k < 3; ++k) at[k * m_width + seat.lane] += force[static_cast<int>(k)];
  }
  void CopyVertex(std::size_t vertex, std::size_t lane, const Real* from);
  void AddErrors(const Real* sums, double weight);
  void UpdateAllAnchors();

  [[nodiscard]] Member& MemberIn(std::size_t lane) const { return *m_system.Members()[m_whose[lane]]; }
  // Rows leave out what has torn.
  [[nodiscard]] bool HasWhole() const { return (m_plan.tears || m_isCut) && !m_byRows; }
  [[nodiscard]] PackSeat FindSeat(std::size_t lane, std::size_t vertex) const {
    if (m_byRows) return {m_grid.RowOf(vertex), m_grid.ColumnOf(vertex)};
    return {m_plan.places[vertex], static_cast<std::uint32_t>(lane)};
  }
  [[nodiscard]] const Real* NumbersOf(int stage) const { return stage == 0 ? m_lanes.state : m_lanes.stage; }

  const BodySystem<Real>& m_system;
  std::span<const std::uint32_t> m_whose;
  const Coefficients<Real>& m_body;
  const SweepPlan<Real>& m_plan;
  const GridPlan<Real>& m_grid;
  bool m_byRows;  // places are rows then, and lanes columns
  bool m_isCut;
  SweepTables<Real> m_tables;
  GridTables<Real> m_gridTables;
  const SweepKernel<Real>& m_kernel;
  ContactKernel<Real> m_contactKernel;
  PackScratch<Real>& m_scratch;
  std::size_t m_width;
  SweepLanes<Real> m_lanes;
  Real* m_outer = nullptr;
  Real* m_acceleration = nullptr;
  Real* m_wind = nullptr;
  Real* m_whole = nullptr;
  Real* m_gas = nullptr;
  Real* m_stiffnessFactors = nullptr;
};

}  // namespace wobble::physics
