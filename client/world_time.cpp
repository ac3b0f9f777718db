#include "client/world_time.h"

#include <algorithm>
#include <limits>

namespace wobble::client {
namespace {

// The measured interval between snapshots, in promised ones, up to which it is believed.
constexpr double kMaxIntervalRatio = 3.0;
constexpr double kIntervalSmoothing = 1.0 / 32.0;
// Seconds of play before lateness counts.
constexpr double kSettling = 1.0;

}  // namespace

void WorldTime::Start(const protocol::WelcomeFields& welcome, double now, Statistics& statistics) {
  m_tickHz = welcome.tickHz;
  m_tickSeconds = 1.0 / welcome.tickHz;
  m_snapshotSeconds = 1.0 / welcome.snapshotHz;
  statistics.snapshotInterval = m_snapshotSeconds;
  m_clock.AddArrival(TimeOf(welcome.tick), 1.0, now);
  m_jitter.CountFrom(std::numeric_limits<double>::infinity());
}

void WorldTime::BeginPlay(double now) { m_jitter.CountFrom(now + kSettling); }

SnapshotArrival WorldTime::AddSnapshot(const protocol::SnapshotHead& head, double inputToSnapshot, double now,
                                       Statistics& statistics) {
  const double time = TimeOf(head.tick);
  m_clock.AddArrival(time, head.timeRatio, now);
  if (m_hasSnapshot && head.tick > m_newestTick) {
    const double interval = std::min(TimeOf(head.tick - m_newestTick), kMaxIntervalRatio * m_snapshotSeconds);
    statistics.snapshotInterval += (interval - statistics.snapshotInterval) * kIntervalSmoothing;
  }
  if (!m_hasSnapshot || head.tick > m_newestTick) {
    m_newestTick = head.tick;
    statistics.timeRatio = static_cast<double>(head.timeRatio);
  }
  m_hasSnapshot = true;
  const double behind = m_clock.ServerTime(now) - time;
  m_jitter.AddArrival({.worldTime = time,
                       .lateness = behind,
                       .interval = std::max(statistics.snapshotInterval, m_snapshotSeconds),
                       .now = now});

  if (inputToSnapshot >= 0) {
    statistics.inputToSnapshot = inputToSnapshot;
    m_inputToSnapshot.Record(inputToSnapshot, now);
  }
  // SnapshotArrival::age says why.
  const double trip = std::max(0.0, (m_inputToSnapshot.Read() - m_tickSeconds / 2) / 2);
  statistics.snapshotAge = m_clock.Lateness() + trip;
  return {.tick = head.tick, .age = statistics.snapshotAge, .inputToSnapshot = inputToSnapshot};
}

}  // namespace wobble::client
