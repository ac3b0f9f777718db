// The layout of a pack of bodies side by side: lane l of every vector is body l, a place is a vertex (kernels/sweep.h).
#pragma once

#include "server/physics/packs/pack.h"

namespace wobble::physics {

// Whether springs of the body have torn although its blueprint cannot tear: a blade has cut it. The sweep of rare terms
// (kernels/rare_terms.h) leaves those springs out; the other bodies of the blueprint go through another sweep, so a cut
// body must not share a pack with them.
template <class Real>
[[nodiscard]] bool IsCut(const Member<Real>& member) {
  return !member.load.torn.empty() && !member.blueprint->template ReadPlan<Real>().tears;
}

// See pack.h for what each function does.
template <class Real>
class LaneLayout {
 public:
  // bodies: at most as many as the widest kernel has lanes; all cut, or none.
  LaneLayout(const PackBodies<Real>& bodies, std::span<const SweepKernel<Real>> kernels);

  [[nodiscard]] const SweepKernel<Real>& Kernel() const { return m_kernel; }
  [[nodiscard]] std::size_t Width() const { return static_cast<std::size_t>(m_kernel.width); }
  [[nodiscard]] std::size_t CountPlaces() const { return m_tables.count; }
  [[nodiscard]] std::size_t CountPending() const { return 3 * (m_tables.pendingMask + 1); }
  [[nodiscard]] std::size_t CountWhole() const { return m_hasWhole ? m_plan.arcs.size() : 0; }
  [[nodiscard]] PackSeat FindSeat(std::size_t lane, std::size_t vertex) const {
    return {.place = m_plan.places[vertex], .lane = static_cast<std::uint32_t>(lane)};
  }
  [[nodiscard]] auto SeatsOf(std::size_t lane) const {
    return [places = m_plan.places.data(), lane = static_cast<std::uint32_t>(lane)](std::size_t vertex) {
      return PackSeat{.place = places[vertex], .lane = lane};
    };
  }
  void Load(PackScratch<Real>& scratch, Real* whole, SweepLanes<Real>& lanes) const;
  void Sweep(int stage, Real h, SweepLanes<Real>& lanes) const { m_kernel.stages[stage](m_tables, lanes, h); }
  void CopyToSystem(const Real* numbers) const;
  void CopyToPoints(const Real* numbers) const;
  [[nodiscard]] bool IsInsideOut(const SweepLanes<Real>& lanes, std::size_t lane) const {
    return m_tables.hasGas && !(lanes.sixVolume[lane] > Real(0));
  }

 private:
  void LoadWhole(Real* whole) const;
  void LoadVertices(Real* state) const;

  PackBodies<Real> m_bodies;
  const SweepPlan<Real>& m_plan;
  const SweepKernel<Real>& m_kernel;
  SweepTables<Real> m_tables;
  bool m_hasWhole;  // springs of these bodies may be torn
};

template <class Real>
using LanePack = Pack<Real, LaneLayout<Real>>;

}  // namespace wobble::physics
