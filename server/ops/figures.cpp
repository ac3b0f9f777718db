// Everything is copied by value, so that the endpoint's threads never read the server.
#include "server/ops/figures.h"

namespace wobble::ops {

bool EnergyRound::Advance(const physics::World& world, int tickHz) {
  const auto bodies = world.Bodies();
  const std::size_t most = bodies.size() / static_cast<std::size_t>(tickHz) + 1;
  for (std::size_t i = 0; i < most && m_next < bodies.size(); ++i, ++m_next) {
    m_sum += physics::ComputeEnergy(world, bodies[m_next], m_scratch);
  }
  if (m_next < bodies.size()) return false;
  m_last = std::exchange(m_sum, {});
  m_next = 0;
  return true;
}

namespace {

Condition FindCondition(const server::Server& server, const server::Config& config) {
  if (server.AcceptsJoins()) return Condition::kReady;
  if (server.IsClosing()) return Condition::kClosing;
  const bool isFull = server.CountPlaying() >= static_cast<std::size_t>(config.maxClients);
  return isFull ? Condition::kFull : Condition::kBusy;
}

}  // namespace

void Gauge::Read(const server::Server& server, double now) {
  Figures& f = m_figures;
  f.condition = FindCondition(server, m_config);
  f.told = now;
  f.scene = server.SceneName();
  for (const server::PhaseTimes& tick : server.LastTicks()) {
    f.tickDurations.Record(tick.Sum());
    for (std::size_t i = 0; i < server::kPhaseCount; ++i) f.phaseDurations[i].Record(tick.phases[i]);
    f.overruns += tick.Sum() * m_config.tickHz > 1 ? 1 : 0;
    m_energy.Advance(server.World(), m_config.tickHz);
  }
  f.droppedTicks = server.Clock().DroppedTicks();
  f.slowedTicks = server.Clock().SlowedTicks();
  f.ticks = server.ShownTick();
  f.timeRatio = server.Clock().TimeRatio();
  f.loadShare = server.ReadLoad().Share();
  f.loadLevel = server.ReadLoad().Level();
  f.snapshotHz = server.SnapshotHz();
  f.isPaused = server.IsPaused();
  f.clients = server.CountClients();
  f.maxClients = static_cast<std::size_t>(m_config.maxClients);
  f.bodies = server.World().Bodies().size();
  f.report = server.ReadReport();
  f.counts = server.ReadCounts();
  f.sent = server.ReadSendCounts();
  f.recordsTooLarge = server.CoarsenedRecords();
  f.transport = server.ReadTransport();
  f.energy = m_energy.Last();
}

}  // namespace wobble::ops
