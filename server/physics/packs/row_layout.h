// The layout of a pack that is a single body whose vertices stand in a grid: lane l of every vector is column l of the
// grid, a place is a row (kernels/grid.h). So a lone body fills whole vectors.
#pragma once

#include "server/physics/packs/pack.h"

namespace wobble::physics {

// Whether bodies of this blueprint, so many together, are stepped each by itself in rows rather than side by side in
// lanes. Both give the same bits except with rare terms (kernels/rare_terms.h), which add up in another order; so a
// blueprint that has a grid and such terms always goes by rows.
template <class Real>
[[nodiscard]] bool GoesByRows(const Blueprint& blueprint, std::size_t bodies);

// See pack.h for what each function does.
template <class Real>
class RowLayout {
 public:
  // bodies: one, of a blueprint that has a grid plan.
  RowLayout(const PackBodies<Real>& bodies, std::span<const SweepKernel<Real>> kernels);

  [[nodiscard]] const SweepKernel<Real>& Kernel() const { return m_kernel; }
  [[nodiscard]] std::size_t Width() const { return m_grid.width; }
  [[nodiscard]] std::size_t CountPlaces() const { return m_grid.CountPlaces(); }
  [[nodiscard]] std::size_t CountPending() const { return (m_grid.pendingSize + m_grid.width - 1) / m_grid.width; }
  // Torn springs are left out of the rows of coefficients.
  [[nodiscard]] std::size_t CountWhole() const { return 0; }
  [[nodiscard]] PackSeat FindSeat(std::size_t, std::size_t vertex) const {
    return {.place = m_grid.RowOf(vertex), .lane = m_grid.ColumnOf(vertex)};
  }
  [[nodiscard]] auto SeatsOf(std::size_t) const {
    return [this](std::size_t vertex) { return FindSeat(0, vertex); };
  }
  void Load(PackScratch<Real>& scratch, Real* whole, SweepLanes<Real>& lanes);
  void Sweep(int stage, Real h, SweepLanes<Real>& lanes) const { m_kernel.gridStages[stage](m_tables, lanes, h); }
  void CopyToSystem(const Real* numbers) const;
  void CopyToPoints(const Real* numbers) const;
  // A body with gas has no grid plan.
  [[nodiscard]] bool IsInsideOut(const SweepLanes<Real>&, std::size_t) const { return false; }

 private:
  void LoadVertices(SweepLanes<Real>& lanes) const;
  void LeaveTornOut(GridRows<Real>& tornRows);

  PackBodies<Real> m_bodies;
  const Coefficients<Real>& m_body;
  const GridPlan<Real>& m_grid;
  const SweepKernel<Real>& m_kernel;
  GridTables<Real> m_tables;
};

template <class Real>
using RowPack = Pack<Real, RowLayout<Real>>;

}  // namespace wobble::physics
