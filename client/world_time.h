// The time in the world of the server, and the moment of it that is shown.
#pragma once

#include <cstdint>

#include "client/client.h"
#include "client/timing/clock.h"
#include "client/timing/jitter_buffer.h"
#include "protocol/snapshot.h"

namespace wobble::client {

// World time is in seconds since tick 0; `now` is in seconds and never goes backwards.
class WorldTime {
 public:
  // Once, with the welcome: its tick gives a first estimate of the time, which the stamps of inputs need.
  void Start(const protocol::WelcomeFields& welcome, double now, Statistics& statistics);

  // The download is over: what comes late from now on says something about the link.
  void BeginPlay(double now);

  // A snapshot packet that has come for the first time. inputToSnapshot: what InputStream::MeasureEcho says of it.
  // Updates the fields of `statistics` that are about time.
  SnapshotArrival AddSnapshot(const protocol::SnapshotHead& head, double inputToSnapshot, double now,
                              Statistics& statistics);

  // Moves the shown moment on. Only once HasSnapshot.
  void Advance(double now) { m_jitter.Advance(m_clock.ServerTime(now), m_clock.TimeRatio(), now); }

  [[nodiscard]] bool HasSnapshot() const { return m_hasSnapshot; }
  // The newest tick of which a snapshot has come; 0 before the first.
  [[nodiscard]] std::uint32_t NewestTick() const { return m_newestTick; }
  [[nodiscard]] int TickHz() const { return m_tickHz; }
  [[nodiscard]] double TickSeconds() const { return m_tickSeconds; }
  [[nodiscard]] double TimeOf(std::uint32_t tick) const { return static_cast<double>(tick) * m_tickSeconds; }

  // Estimate; 0 before Start.
  [[nodiscard]] double ServerTime(double now) const { return m_clock.ServerTime(now); }
  // The moment that is shown, and how far it lies behind ServerTime, seconds.
  [[nodiscard]] double Playback() const { return m_jitter.Playback(); }
  [[nodiscard]] double Delay() const { return m_jitter.Delay(); }

 private:
  int m_tickHz = 0;
  double m_tickSeconds = 0;
  double m_snapshotSeconds = 0;  // between snapshots, as the welcome promised
  bool m_hasSnapshot = false;
  std::uint32_t m_newestTick = 0;
  RecentMinimum m_inputToSnapshot;
  Clock m_clock;
  JitterBuffer m_jitter;
};

}  // namespace wobble::client
