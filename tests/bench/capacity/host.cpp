// The time of a tick is thread time, because wall time on a shared machine measures other load. The server gets the
// same clock, so that its load control ignores that load too. Reading this clock is a system call, also once per
// encoded body: about 0.1 ms a tick at 64 players, which counts as the server's time.
#include "tests/bench/capacity/host.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "tests/bench/contact/bodies.h"
#include "tests/bench/thread_time.h"

namespace wobble::bench {
namespace {

constexpr std::uint32_t kLookEvery = 15;      // ticks
constexpr std::size_t kMostTicks = 60 * 600;  // capacity reserved from the start

Sums ReadSums(const server::Server& server) {
  const server::SendCounts& sent = server.ReadSendCounts();
  return {.ticks = server.World().Tick(),
          .packets = sent.packets,
          .bytes = server.ReadTransport().bytesOut,
          .vertices = sent.vertices,
          .errorSquares = sent.errorSquares,
          .leftOut = sent.bodiesLeftOut,
          .dropped = server.Clock().DroppedTicks(),
          .quarantined = server.ReadCounts().quarantined};
}

}  // namespace

Host::Host(server::Server& server) : m_server(server) {
  m_hosted.ticks.reserve(kMostTicks);
  m_hosted.walls.reserve(kMostTicks);
}

void Host::Run(const std::atomic<Stage>& stage) {
  for (Stage now = stage; now != Stage::kOver; now = stage) {
    if (now != m_stage) Enter(now);
    const double began = ReadWallTime();
    const int ticks = m_server.Tick(began);
    if (ticks > 0 && m_stage == Stage::kCount) CountTicks((ReadWallTime() - began) / ticks);
    if (ticks > 0 && m_stage == Stage::kShow) KeepTruth();
    const double wait = m_server.NextCall() - ReadWallTime();
    if (wait > 0) std::this_thread::sleep_for(std::chrono::duration<double>(wait));
  }
}

void Host::Enter(Stage stage) {
  const double now = ReadWallTime();
  if (stage == Stage::kCount) m_hosted.before = ReadSums(m_server);
  if (m_stage == Stage::kCount) {
    m_hosted.after = ReadSums(m_server);
    m_hosted.seconds = now - m_entered;
    m_hosted.bodies = m_server.World().Bodies().size();
  }
  if (stage == Stage::kShow) {
    for (const physics::Body& body : m_server.World().Bodies()) m_hosted.places.push_back(body.id);
    m_removals = m_server.World().Changes().removals;
  }
  m_stage = stage;
  m_entered = now;
}

void Host::CountTicks(double wall) {
  for (const server::PhaseTimes& tick : m_server.LastTicks()) {
    if (tick.Sum() > m_longest) {
      m_longest = tick.Sum();
      m_hosted.worstTick = m_server.World().Tick();
    }
    m_hosted.ticks.push_back(tick);
    m_hosted.walls.push_back(wall);
  }
  const physics::StepReport& report = m_server.ReadReport();
  m_hosted.awake += report.awake;
  m_hosted.substeps += report.substeps;
  m_hosted.allSubsteps += report.allSubsteps;
  m_hosted.level = std::max(m_hosted.level, m_server.ReadLoad().Level());
  const physics::World& world = m_server.World();
  if (world.Tick() % kLookEvery != 0) return;
  m_hosted.contacts.Look(world);
  for (const physics::Body& body : world.Bodies()) m_hosted.speeds.push_back(FindVelocity(world, body).norm());
}

void Host::KeepTruth() {
  m_hosted.truth.Add(m_server.World());
  if (m_server.World().Changes().removals != m_removals) m_hosted.hasAllPlaces = false;
}

}  // namespace wobble::bench
