// The half of a pack that does not depend on its layout: its arrays, the forces from outside the sweep, contacts with
// static surfaces and the error estimate.
#include "server/physics/packs/pack.h"

#include <cmath>
#include <utility>

#include "server/physics/methods/recovery.h"
#include "server/physics/packs/lane_layout.h"
#include "server/physics/packs/row_layout.h"

namespace wobble::physics {

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

template <class Real, class Layout>
Pack<Real, Layout>::Pack(const PackBodies<Real>& bodies, std::span<const SweepKernel<Real>> kernels,
                         PackScratch<Real>& scratch)
    : m_bodies(bodies),
      m_body(bodies.MemberIn(0).blueprint->template Read<Real>()),
      m_layout(bodies, kernels),
      m_contactKernel(kernels.back().computeContacts),
      m_scratch(scratch),
      m_width(m_layout.Width()) {
  LayOut();
  LoadBodies();
  m_layout.Load(m_scratch, m_whole, m_lanes);
  LoadContacts();
}

// All arrays stand in one block, each aligned to a line of the cache.
template <class Real, class Layout>
void Pack<Real, Layout>::LayOut() {
  const std::size_t count = m_layout.CountPlaces();
  const std::size_t pending = m_layout.CountPending();
  const std::size_t whole = m_layout.CountWhole();
  const std::pair<Real**, std::size_t> arrays[] = {// and how many vectors each holds
                                                   {&m_lanes.state, 6 * count},
                                                   {&m_lanes.stage, 6 * count},
                                                   {&m_lanes.nextStage, 6 * count},
                                                   {&m_lanes.increments, 6 * count},
                                                   {&m_outer, 3 * count},
                                                   {&m_lanes.pending, pending},
                                                   {&m_acceleration, 3},
                                                   {&m_wind, 3},
                                                   {&m_whole, whole},
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
  m_lanes.whole = whole > 0 ? m_whole : nullptr;
  m_lanes.gas = m_gas;
  m_lanes.stiffnessFactors = m_stiffnessFactors;
  m_scratch.hasOuter.assign(count, 0);
  m_scratch.outerPlaces.clear();
  m_lanes.hasOuter = m_scratch.hasOuter.data();
  for (auto* ofOneBody : {&m_scratch.positions, &m_scratch.velocities, &m_scratch.forces}) {
    ofOneBody->resize(m_body.masses.size());
  }
}

template <class Real, class Layout>
void Pack<Real, Layout>::LoadBodies() {
  for (std::size_t lane = 0; lane < m_width; ++lane) {
    const Load<Real>& load = m_bodies.MemberOrFirst(lane).load;
    for (std::size_t k = 0; k < 3; ++k) m_acceleration[k * m_width + lane] = load.acceleration[static_cast<int>(k)];
    for (std::size_t k = 0; k < 3; ++k) m_wind[k * m_width + lane] = load.wind[static_cast<int>(k)];
    m_gas[lane] = load.gasFactor * m_body.gas;
    m_stiffnessFactors[lane] = load.stiffnessFactor;
  }
}

template <class Real, class Layout>
void Pack<Real, Layout>::LoadContacts() {
  m_scratch.planes.Clear(m_body, m_scratch.hasOuter.size(), m_width);
  m_scratch.contacts.Clear(m_body, m_width);
  for (std::size_t lane = 0; lane < m_bodies.whose.size() && HasContactKernel(m_body.contact.law); ++lane) {
    Member& member = m_bodies.MemberIn(lane);
    for (Contact<Real>& contact : member.state->contacts) {
      const Surface<Real>& surface = member.surfaces[contact.surface];
      const PackSeat seat = m_layout.FindSeat(lane, contact.vertex);
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

template <class Real, class Layout>
void Pack<Real, Layout>::BeginStage(int stage) {
  const Real* from = NumbersOf(stage);
  for (const std::uint32_t place : m_scratch.outerPlaces) m_scratch.hasOuter[place] = 0;
  m_scratch.outerPlaces.clear();
  for (std::size_t lane = 0; lane < m_bodies.whose.size(); ++lane) {
    for (const VertexForce<Real>& push : m_bodies.MemberIn(lane).load.pushes) {
      AddOuterForce(lane, push.vertex, push.force);
    }
    if (m_bodies.MemberIn(lane).load.recovery.Act()) AddRecoveryForces(lane, from);
    if (!HasContactKernel(m_body.contact.law)) AddPlainContactForces(lane, from);
    if (!m_bodies.MemberIn(lane).load.rods.empty()) AddRodForces(lane, from);
  }
  AddPlaneForces(from);
  if (m_scratch.contacts.IsEmpty()) return;
  m_scratch.contacts.FindForces(from, m_contactKernel,
                                [this](const PackSeat& seat, const Vector3<Real>& force) { AddToSeat(seat, force); });
}

// Begins the sum of a place's outer forces, for all lanes.
template <class Real, class Layout>
void Pack<Real, Layout>::ClearOuter(std::uint32_t place) {
  std::fill_n(m_outer + 3 * place * m_width, 3 * m_width, Real(0));
  m_scratch.hasOuter[place] = 1;
  m_scratch.outerPlaces.push_back(place);
}

template <class Real, class Layout>
void Pack<Real, Layout>::AddPlaneForces(const Real* from) {
  if (m_scratch.planes.IsEmpty()) return;
  std::vector<std::uint32_t>& places = m_scratch.outerPlaces;
  OuterLanes<Real> outer{
      .forces = m_outer, .hasForce = m_scratch.hasOuter.data(), .count = static_cast<std::uint32_t>(places.size())};
  places.resize(m_scratch.hasOuter.size());
  outer.places = places.data();
  m_scratch.planes.AddForces(from, m_layout.Kernel().planes, outer);
  places.resize(outer.count);
}

template <class Real, class Layout>
void Pack<Real, Layout>::AddPlainForces(std::size_t lane, const Real* from, const auto& visit, const auto& add) {
  visit([&](std::size_t vertex) {
    CopyVertex(vertex, lane, from);
    m_scratch.forces[vertex].setZero();
  });
  add();
  visit([&](std::size_t vertex) {
    Vector3<Real>& force = m_scratch.forces[vertex];
    if (!force.isZero(Real(0))) AddOuterForce(lane, vertex, force);
    force.setZero();
  });
}

template <class Real, class Layout>
void Pack<Real, Layout>::AddRecoveryForces(std::size_t lane, const Real* from) {
  const auto visitAll = [&](const auto& use) {
    for (std::size_t vertex = 0; vertex < m_body.masses.size(); ++vertex) use(vertex);
  };
  AddPlainForces(lane, from, visitAll, [&] {
    AddRecovery<Real>(m_body, m_bodies.MemberIn(lane).load.recovery, m_scratch.positions, m_scratch.velocities,
                      m_scratch.forces);
  });
}

template <class Real, class Layout>
void Pack<Real, Layout>::AddPlainContactForces(std::size_t lane, const Real* from) {
  const Member& member = m_bodies.MemberIn(lane);
  const std::vector<Contact<Real>>& contacts = member.state->contacts;
  const auto visitTouching = [&](const auto& use) {
    for (const Contact<Real>& contact : contacts) use(contact.vertex);
  };
  AddPlainForces(lane, from, visitTouching, [&] {
    AddContacts<Real>(m_body.contact, m_body.contactShares, member.surfaces, contacts, m_scratch.positions,
                      m_scratch.velocities, m_scratch.forces);
  });
}

template <class Real, class Layout>
void Pack<Real, Layout>::AddRodForces(std::size_t lane, const Real* from) {
  const Member& member = m_bodies.MemberIn(lane);
  const auto visitEnds = [&](const auto& use) {
    for (const NearRod& rod : member.load.rods) {
      use(rod.a);
      use(rod.b);
    }
  };
  AddPlainForces(lane, from, visitEnds, [&] {
    AddRodContacts<Real>(m_body, member.surfaces, member.load.rods, m_scratch.positions, m_scratch.velocities,
                         m_scratch.forces);
  });
}

template <class Real, class Layout>
void Pack<Real, Layout>::Sweep(int stage, Real h) {
  m_lanes.outer = m_scratch.outerPlaces.empty() ? nullptr : m_outer;
  m_layout.Sweep(stage, h, m_lanes);
}

template <class Real, class Layout>
void Pack<Real, Layout>::EndStep(double step, double timeLeft, bool isFirst) {
  if (!isFirst) AddErrors(m_lanes.accelerationErrors, step / 6 * timeLeft);
  AddErrors(m_lanes.velocityErrors, step / 6);
  UpdateAllAnchors(static_cast<Real>(step));
}

template <class Real, class Layout>
void Pack<Real, Layout>::EndTry() const {
  m_layout.CopyToSystem(m_lanes.state);
  m_scratch.planes.WriteBack();
  m_scratch.contacts.WriteBack();
  for (std::size_t lane = 0; lane < m_bodies.whose.size(); ++lane) {
    m_bodies.MemberIn(lane).insideOut = m_layout.IsInsideOut(m_lanes, lane);
  }
}

template <class Real, class Layout>
void Pack<Real, Layout>::CopyVertex(std::size_t vertex, std::size_t lane, const Real* from) {
  const PackSeat seat = m_layout.FindSeat(lane, vertex);
  const Real* numbers = from + 6 * seat.place * m_width + seat.lane;
  for (std::size_t k = 0; k < 3; ++k) {
    m_scratch.positions[vertex][static_cast<int>(k)] = numbers[k * m_width];
    m_scratch.velocities[vertex][static_cast<int>(k)] = numbers[(k + 3) * m_width];
  }
}

// sums: of squares over a body's vertices. The formula is substeps_for_error.h's.
template <class Real, class Layout>
void Pack<Real, Layout>::AddErrors(const Real* sums, double weight) {
  for (std::size_t lane = 0; lane < m_bodies.whose.size(); ++lane) {
    m_bodies.MemberIn(lane).error += weight * std::sqrt(double{sums[lane]} / static_cast<double>(m_body.masses.size()));
  }
}

template <class Real, class Layout>
void Pack<Real, Layout>::UpdateAllAnchors(Real h) {
  if (!m_scratch.planes.IsEmpty()) m_scratch.planes.Update(m_lanes.state, h, m_layout.Kernel().planes);
  if (!m_scratch.contacts.IsEmpty()) m_scratch.contacts.Update(m_lanes.state, h);
  if (HasContactKernel(m_body.contact.law)) return;
  for (std::size_t lane = 0; lane < m_bodies.whose.size(); ++lane) {
    const Member& member = m_bodies.MemberIn(lane);
    for (const Contact<Real>& contact : member.state->contacts) CopyVertex(contact.vertex, lane, m_lanes.state);
    UpdateAnchors<Real>(m_body.contact, member.surfaces, member.state->contacts, h, m_scratch.positions,
                        m_scratch.velocities);
  }
}

template struct PackScratch<float>;
template struct PackScratch<double>;
template class Pack<float, LaneLayout<float>>;
template class Pack<double, LaneLayout<double>>;
template class Pack<float, RowLayout<float>>;
template class Pack<double, RowLayout<double>>;

}  // namespace wobble::physics
