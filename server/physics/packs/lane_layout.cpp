// Filling and reading a pack goes vertex by vertex through all bodies, a block of lanes at a time by transposition in
// registers. Body by body, it would go through the whole pack once for each body.
#include "server/physics/packs/lane_layout.h"

#include <cstddef>
#include <utility>

#include "server/physics/lanes/vertex_rows.h"

namespace wobble::physics {
namespace {

// Bodies whose vectors are turned into lanes at once, and back.
template <class Real>
inline constexpr std::size_t kLanesAtOnce = sizeof(typename RowsOf<Real>::Lanes) / sizeof(Real);

// Writes x y z of kLanesAtOnce bodies to [x y z][lane], lanes `width` apart. from: an array of numbers a body; its x y
// z stand from `at` on and must have a fourth number behind them, which is read and dropped.
template <class Real>
inline __attribute__((always_inline)) void SpreadVertex(const Real* const* from, std::size_t at, Real* to,
                                                        std::size_t width) {
  typename RowsOf<Real>::Lanes rows[4];
  for (std::size_t i = 0; i < 4; ++i) rows[i] = LoadRows(from[i] + at, from[(i + 4) % kLanesAtOnce<Real>] + at);
  Transpose(rows);
  for (std::size_t k = 0; k < 3; ++k) StoreLanes(rows[k], to + k * width);
}

// The reverse, for the first `count` bodies. Overwrites the number behind x y z of each with something undefined.
template <class Real>
inline __attribute__((always_inline)) void CollectVertex(const Real* from, std::size_t width, std::size_t count,
                                                         Real* const* to, std::size_t at) {
  const auto z = LoadLanes(from + 2 * width);
  typename RowsOf<Real>::Lanes rows[4] = {LoadLanes(from), LoadLanes(from + width), z, z};
  Transpose(rows);
  // Unrolled, since registers have no index.
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    ((I < count ? StoreRow(FindRow(rows[I % 4], I >= 4), to[I] + at) : void()), ...);
  }
  (std::make_index_sequence<kLanesAtOnce<Real>>());
}

// The same for x y z vx vy vz, to a MovingPoint of each body.
inline __attribute__((always_inline)) void CollectPoint(const float* from, std::size_t width, std::size_t count,
                                                        float* const* to, std::size_t at) {
  const auto load = [from, width](std::size_t k) { return LoadLanes(from + k * width); };
  RowsOf<float>::Lanes x[4] = {load(0), load(1), load(2), load(2)};
  RowsOf<float>::Lanes v[4] = {load(3), load(4), load(5), load(5)};
  Transpose(x);
  Transpose(v);
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    ((I < count ? StoreLanes(JoinRows(x[I % 4], v[I % 4], I >= 4), to[I] + at) : void()), ...);
  }
  (std::make_index_sequence<kLanesAtOnce<float>>());
}
inline __attribute__((always_inline)) void CollectPoint(const double* from, std::size_t width, std::size_t count,
                                                        double* const* to, std::size_t at) {
  CollectVertex(from, width, count, to, at);
  CollectVertex(from + 3 * width, width, count, to, at + offsetof(MovingPoint<double>, v) / sizeof(double));
}

template <class Value>
void Fetch(const std::vector<Value>& values) {
  constexpr std::size_t kCacheLine = 64;
  const auto* bytes = reinterpret_cast<const char*>(values.data());
  for (std::size_t i = 0; i < values.size() * sizeof(Value); i += kCacheLine) __builtin_prefetch(bytes + i);
}

}  // namespace

template <class Real>
LaneLayout<Real>::LaneLayout(const PackBodies<Real>& bodies, std::span<const SweepKernel<Real>> kernels)
    : m_bodies(bodies),
      m_plan(bodies.MemberIn(0).blueprint->template ReadPlan<Real>()),
      m_kernel(FindNarrowest(kernels, bodies.whose.size())),
      m_tables(m_plan.Tables()) {
  const bool isCut = IsCut(bodies.MemberIn(0));
  m_tables.isRare = m_tables.isRare || isCut;
  m_hasWhole = m_plan.tears || isCut;
}

template <class Real>
void LaneLayout<Real>::Load(PackScratch<Real>&, Real* whole, SweepLanes<Real>& lanes) const {
  if (m_hasWhole) LoadWhole(whole);
  LoadVertices(lanes.state);
  m_kernel.computeVolume(m_tables, lanes);
}

template <class Real>
void LaneLayout<Real>::LoadWhole(Real* whole) const {
  const std::size_t width = Width();
  for (std::size_t lane = 0; lane < width; ++lane) {
    const std::span<const std::uint8_t> torn = m_bodies.MemberOrFirst(lane).load.torn;
    for (std::size_t i = 0; i < m_plan.springs.size(); ++i) {
      whole[i * width + lane] = Real(torn.empty() || torn[m_plan.springs[i]] == 0 ? 1 : 0);
    }
  }
}

// The last vertex goes number by number: its body's array has no fourth number behind it.
template <class Real>
void LaneLayout<Real>::LoadVertices(Real* to) const {
  const std::size_t width = Width();
  std::array<const Real*, kWidestPack> x{};
  std::array<const Real*, kWidestPack> v{};
  for (std::size_t lane = 0; lane < width; ++lane) {
    const State<Real>& state = *m_bodies.MemberOrFirst(lane).state;
    // The loop below reads more arrays side by side than the processor's prefetcher follows; here it follows each.
    Fetch(state.positions);
    Fetch(state.velocities);
    x[lane] = state.positions.data()->data();
    v[lane] = state.velocities.data()->data();
  }
  const std::size_t last = m_tables.count - 1;
  const std::size_t inBlocks = width - width % kLanesAtOnce<Real>;
  for (std::size_t place = 0; place <= last; ++place, to += 6 * width) {
    const std::size_t vertex = m_plan.vertices[place];
    const std::size_t blocks = vertex == last ? 0 : inBlocks;
    for (std::size_t lane = 0; lane < blocks; lane += kLanesAtOnce<Real>) {
      SpreadVertex(&x[lane], 3 * vertex, to + lane, width);
      SpreadVertex(&v[lane], 3 * vertex, to + 3 * width + lane, width);
    }
    for (std::size_t lane = blocks; lane < width; ++lane) {
      for (std::size_t k = 0; k < 3; ++k) {
        to[k * width + lane] = x[lane][3 * vertex + k];
        to[(k + 3) * width + lane] = v[lane][3 * vertex + k];
      }
    }
  }
}

// In the order of vertices, not of places: what CollectVertex leaves behind a vertex is overwritten by the next one.
// The last vertex goes number by number, since what is behind it belongs to another body.
template <class Real>
void LaneLayout<Real>::CopyToSystem(const Real* numbers) const {
  const BodySystem<Real>& system = m_bodies.system;
  const std::size_t width = Width();
  std::array<Real*, kWidestPack> x{};
  std::array<Real*, kWidestPack> v{};
  const std::size_t bodies = m_bodies.whose.size();
  for (std::size_t lane = 0; lane < bodies; ++lane) {
    x[lane] = system.SliceOf(system.Positions(), m_bodies.whose[lane]).data()->data();
    v[lane] = system.SliceOf(system.Velocities(), m_bodies.whose[lane]).data()->data();
  }
  const std::size_t last = m_tables.count - 1;
  const std::size_t inBlocks = width - width % kLanesAtOnce<Real>;
  for (std::size_t vertex = 0; vertex <= last; ++vertex) {
    const Real* const from = numbers + 6 * m_plan.places[vertex] * width;
    const std::size_t blocks = vertex == last ? 0 : std::min(inBlocks, bodies);
    for (std::size_t lane = 0; lane < blocks; lane += kLanesAtOnce<Real>) {
      CollectVertex(from + lane, width, bodies - lane, &x[lane], 3 * vertex);
      CollectVertex(from + 3 * width + lane, width, bodies - lane, &v[lane], 3 * vertex);
    }
    for (std::size_t lane = blocks; lane < bodies; ++lane) {
      for (std::size_t k = 0; k < 3; ++k) {
        x[lane][3 * vertex + k] = from[k * width + lane];
        v[lane][3 * vertex + k] = from[(k + 3) * width + lane];
      }
    }
  }
}

// In the order of vertices, so that the points are written one after the other.
template <class Real>
void LaneLayout<Real>::CopyToPoints(const Real* numbers) const {
  constexpr std::size_t kStride = sizeof(MovingPoint<Real>) / sizeof(Real);
  constexpr std::size_t kVelocity = offsetof(MovingPoint<Real>, v) / sizeof(Real);
  const BodySystem<Real>& system = m_bodies.system;
  const std::size_t width = Width();
  const std::size_t bodies = m_bodies.whose.size();
  std::array<Real*, kWidestPack> points{};
  for (std::size_t lane = 0; lane < bodies; ++lane) {
    points[lane] = system.SliceOf(system.Points(), m_bodies.whose[lane]).data()->x.data();
  }
  const std::size_t blocks = std::min(width - width % kLanesAtOnce<Real>, bodies);
  for (std::size_t vertex = 0; vertex < m_tables.count; ++vertex) {
    const Real* const from = numbers + 6 * m_plan.places[vertex] * width;
    const std::size_t at = kStride * vertex;
    for (std::size_t lane = 0; lane < blocks; lane += kLanesAtOnce<Real>) {
      CollectPoint(from + lane, width, bodies - lane, &points[lane], at);
    }
    for (std::size_t lane = blocks; lane < bodies; ++lane) {
      for (std::size_t k = 0; k < 3; ++k) {
        points[lane][at + k] = from[k * width + lane];
        points[lane][at + kVelocity + k] = from[(k + 3) * width + lane];
      }
    }
  }
}

template class LaneLayout<float>;
template class LaneLayout<double>;

}  // namespace wobble::physics
