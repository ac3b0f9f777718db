// All bodies that have been heard of: their tracks, and how they look at a moment.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "client/client.h"
#include "client/interpolator.h"
#include "client/statistics.h"
#include "protocol/snapshot.h"

namespace wobble::client {

// Seconds of world time after which a body of which nothing came any more is taken to be gone. The server says reliably
// when a body goes; this is for the case that it does not, and long enough for the last in a crowd to have its turn.
// Holds only as long as servers send bodies that lie still, too.
inline constexpr double kForgetAfter = 30.0;
// What all tracks may hold together, vertices, each track counting kTrackCost more for its frame: 5,000 balls of
// 92 vertices. Each is kept up to kTrackSamples times, at 12 bytes: 150 MB at the very worst.
inline constexpr std::size_t kMaxTrackedVertices = std::size_t{1} << 19;
inline constexpr std::size_t kTrackCost = 8;

class Bodies {
 public:
  // A decoded record. shape has as many vertices as that patch of the blueprint. False when it would be one body or
  // vertex too many; what is old, or of a body that has been removed since, is ignored and true.
  [[nodiscard]] bool Add(const protocol::RecordHead& head, const Blueprint& blueprint, std::uint32_t tick, double time,
                         const protocol::Pose& pose, std::span<const protocol::Vector3> shape, double playback);

  // The server removed it at this tick: records of earlier ticks that still come do not bring it back.
  void Remove(std::uint32_t body, std::uint32_t tick);
  // Drops all bodies whose newest sample is older than this, world seconds.
  void Forget(double olderThan);

  // All bodies at `time`, by ascending number. newest: time of the newest tick known. Counts what it shows.
  void Sample(double time, double newest, Detail detail, std::vector<BodySample>& samples, Statistics& statistics);
  [[nodiscard]] std::size_t Count() const { return m_bodies.size(); }

 private:
  struct Body {
    const Blueprint* blueprint = nullptr;
    std::vector<Track> patches;
    std::uint32_t newestTick = 0;
    double newestTime = 0;
    bool wasHeld = false;
  };
  struct Removal {
    std::uint32_t body = 0;  // 0: none
    std::uint32_t tick = 0;
  };
  using BodyMap = std::map<std::uint32_t, Body>;

  Body* FindOrMake(std::uint32_t number, const Blueprint& blueprint);
  [[nodiscard]] bool WasRemoved(std::uint32_t body, std::uint32_t tick) const;
  BodyMap::iterator Erase(BodyMap::iterator body);
  static void SampleBody(const Body& body, double time, double newest, Detail detail, BodySample& sample);

  BodyMap m_bodies;
  std::size_t m_tracked = 0;             // counted against kMaxTrackedVertices
  std::array<Removal, 64> m_removals{};  // the latest; a late record is late by less than these took
  std::size_t m_nextRemoval = 0;
};

}  // namespace wobble::client
