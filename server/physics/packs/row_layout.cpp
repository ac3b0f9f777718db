// Filling and reading are plain copies, since vertices of a row stand one after the other in the body already. A torn
// spring is one without coefficients: its rows are made anew when a pack is filled from a body that has torn.
#include "server/physics/packs/row_layout.h"

namespace wobble::physics {
namespace {

// From so many bodies on, lanes are faster than rows where a blueprint allows both. Measured in float with AVX-512, ns
// a vertex and step of a lattice of 64 vertices: 42 by rows; in lanes 104 alone, 83 with two, 42 with four, 21 with
// eight, 15 with sixteen.
constexpr std::size_t kFewestInLanes = 5;

}  // namespace

template <class Real>
bool GoesByRows(const Blueprint& blueprint, std::size_t bodies) {
  return blueprint.ReadGridPlan<Real>().rows > 0 && (blueprint.ReadPlan<Real>().isRare || bodies < kFewestInLanes);
}

template <class Real>
RowLayout<Real>::RowLayout(const PackBodies<Real>& bodies, std::span<const SweepKernel<Real>> kernels)
    : m_bodies(bodies),
      m_body(bodies.MemberIn(0).blueprint->template Read<Real>()),
      m_grid(bodies.MemberIn(0).blueprint->template ReadGridPlan<Real>()),
      m_kernel(FindNarrowest(kernels, m_grid.columns)),
      m_tables(m_grid.Tables(m_grid.coefficients)) {}

template <class Real>
void RowLayout<Real>::Load(PackScratch<Real>& scratch, Real*, SweepLanes<Real>& lanes) {
  LoadVertices(lanes);
  LeaveTornOut(scratch.tornRows);
}

// Lanes beside the last column, and the row behind the last, are 0: a sweep reads them and they must be finite.
template <class Real>
void RowLayout<Real>::LoadVertices(SweepLanes<Real>& lanes) const {
  const State<Real>& state = *m_bodies.MemberIn(0).state;
  const std::size_t columns = m_grid.columns;
  const std::size_t width = m_grid.width;
  Real* row = lanes.state;
  for (std::size_t vertex = 0; vertex < m_body.masses.size(); row += 6 * width) {
    for (std::size_t column = 0; column < columns; ++column, ++vertex) {
      for (std::size_t k = 0; k < 3; ++k) {
        row[k * width + column] = state.positions[vertex][static_cast<int>(k)];
        row[(k + 3) * width + column] = state.velocities[vertex][static_cast<int>(k)];
      }
    }
  }
  for (Real* array : {lanes.state, lanes.stage, lanes.nextStage}) {
    for (std::size_t i = 0; i < 6 * m_grid.rows; ++i) {
      std::fill_n(array + i * width + columns, width - columns, Real(0));
    }
    std::fill_n(array + 6 * m_grid.rows * width, 6 * width, Real(0));
  }
}

template <class Real>
void RowLayout<Real>::LeaveTornOut(GridRows<Real>& tornRows) {
  const std::span<const std::uint8_t> torn = m_bodies.MemberIn(0).load.torn;
  if (std::all_of(torn.begin(), torn.end(), [](std::uint8_t each) { return each == 0; })) return;
  RemoveTorn(m_grid, m_body, torn, tornRows);
  m_tables = m_grid.Tables(tornRows);
}

template <class Real>
void RowLayout<Real>::CopyToSystem(const Real* numbers) const {
  const BodySystem<Real>& system = m_bodies.system;
  const std::size_t width = m_grid.width;
  Vector3<Real>* x = system.SliceOf(system.Positions(), m_bodies.whose[0]).data();
  Vector3<Real>* v = system.SliceOf(system.Velocities(), m_bodies.whose[0]).data();
  const Real* row = numbers;
  for (std::size_t vertex = 0; vertex < m_body.masses.size(); row += 6 * width) {
    for (std::size_t column = 0; column < m_grid.columns; ++column, ++vertex) {
      for (std::size_t k = 0; k < 3; ++k) {
        x[vertex][static_cast<int>(k)] = row[k * width + column];
        v[vertex][static_cast<int>(k)] = row[(k + 3) * width + column];
      }
    }
  }
}

template <class Real>
void RowLayout<Real>::CopyToPoints(const Real* numbers) const {
  const BodySystem<Real>& system = m_bodies.system;
  const std::size_t width = m_grid.width;
  MovingPoint<Real>* point = system.SliceOf(system.Points(), m_bodies.whose[0]).data();
  const MovingPoint<Real>* const end = point + m_body.masses.size();
  for (const Real* row = numbers; point != end; row += 6 * width) {
    for (std::size_t column = 0; column < m_grid.columns; ++column, ++point) {
      for (std::size_t k = 0; k < 3; ++k) {
        point->x[static_cast<int>(k)] = row[k * width + column];
        point->v[static_cast<int>(k)] = row[(k + 3) * width + column];
      }
    }
  }
}

template bool GoesByRows<float>(const Blueprint&, std::size_t);
template bool GoesByRows<double>(const Blueprint&, std::size_t);
template class RowLayout<float>;
template class RowLayout<double>;

}  // namespace wobble::physics
