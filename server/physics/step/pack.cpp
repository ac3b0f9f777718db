#include "server/physics/step/pack.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "server/physics/lanes/vertex_rows.h"
#include "server/physics/methods/step_choice.h"

namespace wobble::physics {
namespace {

template <class Real>
const SweepKernel<Real>& FindNarrowest(std::span<const SweepKernel<Real>> kernels, std::size_t lanes) {
  return *std::find_if(kernels.begin(), kernels.end() - 1, [lanes](const SweepKernel<Real>& kernel) {
    return static_cast<std::size_t>(kernel.width) >= lanes;
  });
}

// From so many bodies on, lanes are faster than rows where a blueprint has both. Measured in float with AVX-512, ns a
// vertex and step of a lattice of 64 vertices: 42 by rows; in lanes 104 alone, 83 with two, 42 with four, 21 with
// eight, 15 with sixteen.
constexpr std::size_t kFewestInLanes = 5;

// Lanes that are turned into bodies' vectors, or these into them, at once.
template <class Real>
inline constexpr std::size_t kLanesAtOnce = sizeof(typename RowsOf<Real>::Lanes) / sizeof(Real);

// from: so many bodies' numbers, of which x y z stand from `at` on, with a number behind that is left out. To
// [x y z][lane], lanes `width` apart.
template <class Real>
inline __attribute__((always_inline)) void SpreadVertex(const Real* const* from, std::size_t at, Real* to,
                                                        std::size_t width) {
  typename RowsOf<Real>::Lanes rows[4];
  for (std::size_t i = 0; i < 4; ++i) rows[i] = LoadRows(from[i] + at, from[(i + 4) % kLanesAtOnce<Real>] + at);
  Transpose(rows);
  for (std::size_t k = 0; k < 3; ++k) StoreLanes(rows[k], to + k * width);
}

// The other way round, for the first `count` of them. Something is left behind each.
template <class Real>
inline __attribute__((always_inline)) void CollectVertex(const Real* from, std::size_t width, std::size_t count,
                                                         Real* const* to, std::size_t at) {
  const auto z = LoadLanes(from + 2 * width);
  typename RowsOf<Real>::Lanes rows[4] = {LoadLanes(from), LoadLanes(from + width), z, z};
  Transpose(rows);
  // One by one, since registers have no index.
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    ((I < count ? StoreRow(FindRow(rows[I % 4], I >= 4), to[I] + at) : void()), ...);
  }
  (std::make_index_sequence<kLanesAtOnce<Real>>());
}

template <class Value>
void Fetch(const std::vector<Value>& values) {
  constexpr std::size_t kCacheLine = 64;
  const auto* bytes = reinterpret_cast<const char*>(values.data());
  for (std::size_t i = 0; i < values.size() * sizeof(Value); i += kCacheLine) __builtin_prefetch(bytes + i);
}

}  // namespace

template <class Real>
bool GoesByRows(const Blueprint& blueprint, std::size_t bodies) {
  return blueprint.ReadGridPlan<Real>().rows > 0 && (blueprint.ReadPlan<Real>().isRare || bodies < kFewestInLanes);
}

template <class Real>
void PackScratch<Real>::Reserve(std::size_t vertices) {
  lines.reserve((6 * 4 + 3 + 6) * vertices * kWidestPack * sizeof(Real) / sizeof(Line) + 16 * kWidestPack);
  hasOuter.reserve(vertices);
  outerPlaces.reserve(vertices);
  positions.reserve(vertices);
  velocities.reserve(vertices);
  forces.reserve(vertices);
  planes.Reserve(vertices);
  contacts.Reserve(kWidestPack * vertices);
}

template <class Real>
Pack<Real>::Pack(const BodySystem<Real>& system, std::span<const std::uint32_t> whose, bool byRows,
                 std::span<const SweepKernel<Real>> kernels, PackScratch<Real>& scratch)
    : m_system(system),
      m_whose(whose),
      m_body(system.Members()[whose[0]]->blueprint->template Read<Real>()),
      m_plan(system.Members()[whose[0]]->blueprint->template ReadPlan<Real>()),
      m_grid(system.Members()[whose[0]]->blueprint->template ReadGridPlan<Real>()),
      m_byRows(byRows),
      m_isCut(IsCut(*system.Members()[whose[0]])),
      m_tables(m_plan.Tables()),
      m_gridTables(m_grid.Tables(m_grid.coefficients)),
      m_kernel(FindNarrowest(kernels, byRows ? m_grid.columns : whose.size())),
      m_contactKernel(kernels.back().computeContacts),
      m_scratch(scratch),
      m_width(byRows ? m_grid.width : static_cast<std::size_t>(m_kernel.width)) {
  m_tables.isRare = m_tables.isRare || m_isCut;
  LayOut();
  LoadBodies();
  if (m_byRows) {
    LoadRows();
    LeaveTornOut();
  } else {
    LoadVertices();
    m_kernel.computeVolume(m_tables, m_lanes);
  }
  LoadContacts();
}

template <class Real>
void Pack<Real>::LoadContacts() {
  m_scratch.planes.Clear(m_body, m_scratch.hasOuter.size(), m_width);
  m_scratch.contacts.Clear(m_body, m_width);
  for (std::size_t lane = 0; lane < m_whose.size() && IsBulkLaw(m_body.contact.law); ++lane) {
    Member& member = MemberIn(lane);
    for (Contact<Real>& contact : member.state->contacts) {
      const Surface<Real>& surface = member.surfaces[contact.surface];
      const PackSeat seat = FindSeat(lane, contact.vertex);
      if (surface.kind == Obstacle::Kind::kPlane) {
        m_scratch.planes.Add(seat, surface, contact);
      } else {
        m_scratch.contacts.Add(seat, surface, contact);
      }
    }
  }
  m_scratch.planes.Close();
  m_scratch.contacts.Close();
}

// One block for all arrays, each of them aligned.
template <class Real>
void Pack<Real>::LayOut() {
  const std::size_t count = m_byRows ? m_grid.CountPlaces() : m_tables.count;
  const std::size_t pending = m_byRows ? (m_grid.pendingSize + m_width - 1) / m_width : 3 * (m_tables.pendingMask + 1);
  const std::pair<Real**, std::size_t> arrays[] = {// and how many vectors each holds
                                                   {&m_lanes.state, 6 * count},
                                                   {&m_lanes.stage, 6 * count},
                                                   {&m_lanes.nextStage, 6 * count},
                                                   {&m_lanes.increments, 6 * count},
                                                   {&m_outer, 3 * count},
                                                   {&m_lanes.pending, pending},
                                                   {&m_acceleration, 3},
                                                   {&m_wind, 3},
                                                   {&m_whole, HasWhole() ? m_plan.arcs.size() : 0},
                                                   {&m_gas, 1},
                                                   {&m_stiffnessFactors, 1},
                                                   {&m_lanes.sixVolume, 1},
                                                   {&m_lanes.velocityErrors, 1},
                                                   {&m_lanes.accelerationErrors, 1}};
  using Line = typename PackScratch<Real>::Line;
  const auto countLines = [this](std::size_t vectors) {
    return (vectors * m_width * sizeof(Real) + sizeof(Line) - 1) / sizeof(Line);
  };
  std::size_t lines = 0;
  for (const auto& [array, vectors] : arrays) lines += countLines(vectors);
  if (m_scratch.lines.size() < lines) m_scratch.lines.resize(lines);
  Line* at = m_scratch.lines.data();
  for (const auto& [array, vectors] : arrays) {
    *array = reinterpret_cast<Real*>(at);
    at += countLines(vectors);
  }
  std::fill_n(m_lanes.pending, pending * m_width, Real(0));
  m_lanes.acceleration = m_acceleration;
  m_lanes.wind = m_wind;
  m_lanes.whole = HasWhole() ? m_whole : nullptr;
  m_lanes.gas = m_gas;
  m_lanes.stiffnessFactors = m_stiffnessFactors;
  m_scratch.hasOuter.assign(count, 0);
  m_scratch.outerPlaces.clear();
  m_lanes.hasOuter = m_scratch.hasOuter.data();
  for (auto* ofOneBody : {&m_scratch.positions, &m_scratch.velocities, &m_scratch.forces}) {
    ofOneBody->resize(m_body.masses.size());
  }
}

// Lanes to spare repeat the first body: they cost nothing more, and numbers that are none would.
template <class Real>
void Pack<Real>::LoadBodies() {
  for (std::size_t lane = 0; lane < m_width; ++lane) {
    const Load<Real>& load = MemberIn(lane < m_whose.size() ? lane : 0).load;
    for (std::size_t k = 0; k < 3; ++k) m_acceleration[k * m_width + lane] = load.acceleration[static_cast<int>(k)];
    for (std::size_t k = 0; k < 3; ++k) m_wind[k * m_width + lane] = load.wind[static_cast<int>(k)];
    for (std::size_t i = 0; HasWhole() && i < m_plan.springs.size(); ++i) {
      m_whole[i * m_width + lane] = Real(load.torn.empty() || load.torn[m_plan.springs[i]] == 0 ? 1 : 0);
    }
    m_gas[lane] = load.gasFactor * m_body.gas;
    m_stiffnessFactors[lane] = load.stiffnessFactor;
  }
}

// Vertex by vertex through all bodies, a block of lanes at a time: body by body would go through the whole pack once
// for each. Of the last vertex there is no number behind.
template <class Real>
void Pack<Real>::LoadVertices() {
  std::array<const Real*, kWidestPack> x{};
  std::array<const Real*, kWidestPack> v{};
  for (std::size_t lane = 0; lane < m_width; ++lane) {
    const State<Real>& state = *MemberIn(lane < m_whose.size() ? lane : 0).state;
    // So many side by side are more than a processor sees coming, one behind the other it does.
    Fetch(state.positions);
    Fetch(state.velocities);
    x[lane] = state.positions.data()->data();
    v[lane] = state.velocities.data()->data();
  }
  const std::size_t last = m_tables.count - 1;
  const std::size_t inBlocks = m_width - m_width % kLanesAtOnce<Real>;
  Real* to = m_lanes.state;
  for (std::size_t place = 0; place <= last; ++place, to += 6 * m_width) {
    const std::size_t vertex = m_plan.vertices[place];
    const std::size_t blocks = vertex == last ? 0 : inBlocks;
    for (std::size_t lane = 0; lane < blocks; lane += kLanesAtOnce<Real>) {
      SpreadVertex(&x[lane], 3 * vertex, to + lane, m_width);
      SpreadVertex(&v[lane], 3 * vertex, to + 3 * m_width + lane, m_width);
    }
    for (std::size_t lane = blocks; lane < m_width; ++lane) {
      for (std::size_t k = 0; k < 3; ++k) {
        to[k * m_width + lane] = x[lane][3 * vertex + k];
        to[(k + 3) * m_width + lane] = v[lane][3 * vertex + k];
      }
    }
  }
}

// All that a sweep may look at beyond the vertices is 0.
template <class Real>
void Pack<Real>::LoadRows() {
  const State<Real>& state = *MemberIn(0).state;
  const std::size_t columns = m_grid.columns;
  Real* row = m_lanes.state;
  for (std::size_t vertex = 0; vertex < m_body.masses.size(); row += 6 * m_width) {
    for (std::size_t column = 0; column < columns; ++column, ++vertex) {
      for (std::size_t k = 0; k < 3; ++k) {
        row[k * m_width + column] = state.positions[vertex][static_cast<int>(k)];
        row[(k + 3) * m_width + column] = state.velocities[vertex][static_cast<int>(k)];
      }
    }
  }
  for (Real* array : {m_lanes.state, m_lanes.stage, m_lanes.nextStage}) {
    for (std::size_t i = 0; i < 6 * m_grid.rows; ++i) {
      std::fill_n(array + i * m_width + columns, m_width - columns, Real(0));
    }
    std::fill_n(array + 6 * m_grid.rows * m_width, 6 * m_width, Real(0));
  }
}

template <class Real>
void Pack<Real>::LeaveTornOut() {
  const std::span<const std::uint8_t> torn = MemberIn(0).load.torn;
  if (std::all_of(torn.begin(), torn.end(), [](std::uint8_t each) { return each == 0; })) return;
  RemoveTorn(m_grid, m_body, torn, m_scratch.tornRows);
  m_gridTables = m_grid.Tables(m_scratch.tornRows);
}

template <class Real>
void Pack<Real>::CopyRowsToSystem(int stage) const {
  Vector3<Real>* x = m_system.SliceOf(m_system.Positions(), m_whose[0]).data();
  Vector3<Real>* v = m_system.SliceOf(m_system.Velocities(), m_whose[0]).data();
  const Real* row = NumbersOf(stage);
  for (std::size_t vertex = 0; vertex < m_body.masses.size(); row += 6 * m_width) {
    for (std::size_t column = 0; column < m_grid.columns; ++column, ++vertex) {
      for (std::size_t k = 0; k < 3; ++k) {
        x[vertex][static_cast<int>(k)] = row[k * m_width + column];
        v[vertex][static_cast<int>(k)] = row[(k + 3) * m_width + column];
      }
    }
  }
}

// As it was filled, but in the order of vertices: what is put behind one is overwritten by the next, and the last has
// nothing behind that is this body's.
template <class Real>
void Pack<Real>::CopyToSystem(int stage) const {
  if (m_byRows) return CopyRowsToSystem(stage);
  std::array<Real*, kWidestPack> x{};
  std::array<Real*, kWidestPack> v{};
  const std::size_t bodies = m_whose.size();
  for (std::size_t lane = 0; lane < bodies; ++lane) {
    x[lane] = m_system.SliceOf(m_system.Positions(), m_whose[lane]).data()->data();
    v[lane] = m_system.SliceOf(m_system.Velocities(), m_whose[lane]).data()->data();
  }
  const Real* const numbers = NumbersOf(stage);
  const std::size_t last = m_tables.count - 1;
  const std::size_t inBlocks = m_width - m_width % kLanesAtOnce<Real>;
  for (std::size_t vertex = 0; vertex <= last; ++vertex) {
    const Real* const from = numbers + 6 * m_plan.places[vertex] * m_width;
    const std::size_t blocks = vertex == last ? 0 : std::min(inBlocks, bodies);
    for (std::size_t lane = 0; lane < blocks; lane += kLanesAtOnce<Real>) {
      CollectVertex(from + lane, m_width, bodies - lane, &x[lane], 3 * vertex);
      CollectVertex(from + 3 * m_width + lane, m_width, bodies - lane, &v[lane], 3 * vertex);
    }
    for (std::size_t lane = blocks; lane < bodies; ++lane) {
      for (std::size_t k = 0; k < 3; ++k) {
        x[lane][3 * vertex + k] = from[k * m_width + lane];
        v[lane][3 * vertex + k] = from[(k + 3) * m_width + lane];
      }
    }
  }
}

template <class Real>
void Pack<Real>::BeginStage(int stage) {
  const Real* from = NumbersOf(stage);
  for (const std::uint32_t place : m_scratch.outerPlaces) m_scratch.hasOuter[place] = 0;
  m_scratch.outerPlaces.clear();
  for (std::size_t lane = 0; lane < m_whose.size(); ++lane) {
    for (const VertexForce<Real>& push : MemberIn(lane).load.pushes) AddOuterForce(lane, push.vertex, push.force);
    if (!IsBulkLaw(m_body.contact.law)) AddUnbulkedForces(lane, from);
  }
  AddPlaneForces(from);
  if (m_scratch.contacts.IsEmpty()) return;
  m_scratch.contacts.FindForces(from, m_contactKernel,
                                [this](const PackSeat& seat, const Vector3<Real>& force) { AddToSeat(seat, force); });
}

template <class Real>
void Pack<Real>::AddPlaneForces(const Real* from) {
  if (m_scratch.planes.IsEmpty()) return;
  std::vector<std::uint32_t>& places = m_scratch.outerPlaces;
  OuterLanes<Real> outer{m_outer, m_scratch.hasOuter.data(), nullptr, static_cast<std::uint32_t>(places.size())};
  places.resize(m_scratch.hasOuter.size());
  outer.places = places.data();
  m_scratch.planes.AddForces(from, m_kernel.planes, outer);
  places.resize(outer.count);
}

template <class Real>
void Pack<Real>::AddUnbulkedForces(std::size_t lane, const Real* from) {
  const Member& member = MemberIn(lane);
  const std::vector<Contact<Real>>& contacts = member.state->contacts;
  for (const Contact<Real>& contact : contacts) {
    CopyVertex(contact.vertex, lane, from);
    m_scratch.forces[contact.vertex].setZero();
  }
  AddContacts<Real>(m_body.contact, m_body.contactShares, member.surfaces, contacts, m_scratch.positions,
                    m_scratch.velocities, m_scratch.forces);
  for (const Contact<Real>& contact : contacts) {
    Vector3<Real>& force = m_scratch.forces[contact.vertex];
    if (!force.isZero(Real(0))) AddOuterForce(lane, contact.vertex, force);
    force.setZero();  // a vertex may have several contacts
  }
}

template <class Real>
void Pack<Real>::Sweep(int stage, Real h) {
  m_lanes.outer = m_scratch.outerPlaces.empty() ? nullptr : m_outer;
  if (m_byRows) {
    m_kernel.gridStages[stage](m_gridTables, m_lanes, h);
  } else {
    m_kernel.stages[stage](m_tables, m_lanes, h);
  }
}

template <class Real>
void Pack<Real>::EndStep(double step, double timeLeft, bool isFirst) {
  if (!isFirst) AddErrors(m_lanes.accelerationErrors, step / 6 * timeLeft);
  AddErrors(m_lanes.velocityErrors, step / 6);
  UpdateAllAnchors();
}

template <class Real>
void Pack<Real>::EndTry() const {
  CopyToSystem(0);
  m_scratch.planes.WriteBack();
  m_scratch.contacts.WriteBack();
  for (std::size_t lane = 0; lane < m_whose.size(); ++lane) {
    MemberIn(lane).insideOut = m_tables.hasGas && !(m_lanes.sixVolume[lane] > Real(0));
  }
}

template <class Real>
void Pack<Real>::CopyVertex(std::size_t vertex, std::size_t lane, const Real* from) {
  const PackSeat seat = FindSeat(lane, vertex);
  const Real* numbers = from + 6 * seat.place * m_width + seat.lane;
  for (std::size_t k = 0; k < 3; ++k) {
    m_scratch.positions[vertex][static_cast<int>(k)] = numbers[k * m_width];
    m_scratch.velocities[vertex][static_cast<int>(k)] = numbers[(k + 3) * m_width];
  }
}

// sums: of squares over a body's vertices.
template <class Real>
void Pack<Real>::AddErrors(const Real* sums, double weight) {
  for (std::size_t lane = 0; lane < m_whose.size(); ++lane) {
    MemberIn(lane).error += weight * std::sqrt(double{sums[lane]} / static_cast<double>(m_body.masses.size()));
  }
}

template <class Real>
void Pack<Real>::UpdateAllAnchors() {
  if (!m_scratch.planes.IsEmpty()) m_scratch.planes.Update(m_lanes.state, m_kernel.planes);
  if (!m_scratch.contacts.IsEmpty()) m_scratch.contacts.Update(m_lanes.state);
  if (IsBulkLaw(m_body.contact.law)) return;
  for (std::size_t lane = 0; lane < m_whose.size(); ++lane) {
    const Member& member = MemberIn(lane);
    for (const Contact<Real>& contact : member.state->contacts) CopyVertex(contact.vertex, lane, m_lanes.state);
    UpdateAnchors<Real>(m_body.contact, member.surfaces, member.state->contacts, m_scratch.positions);
  }
}

template bool GoesByRows<float>(const Blueprint&, std::size_t);
template bool GoesByRows<double>(const Blueprint&, std::size_t);
template struct PackScratch<float>;
template struct PackScratch<double>;
template class Pack<float>;
template class Pack<double>;

}  // namespace wobble::physics
