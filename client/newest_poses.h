// Where every body was when it was last heard of, from the heads of records alone: no vertex is decoded, so a load test
// can know it for hundreds of clients.
#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "client/client.h"
#include "protocol/pose.h"

namespace wobble::client {

// Poses further apart than this say nothing of how fast a body goes now, seconds of world time.
inline constexpr double kMaxVelocitySpan = 0.5;

class NewestPoses {
 public:
  // A record of the body's first patch. What is not newer than the newest known, or than a removal, is ignored; so is a
  // body beyond protocol::kMaxBodies.
  void Add(std::uint32_t body, std::uint32_t tick, bool rests, const protocol::QuantisedPose& pose);
  // As the server's events say it: from this tick on the body is gone, or somewhere else.
  void Remove(std::uint32_t body, std::uint32_t tick);
  void NoteRespawn(std::uint32_t body, std::uint32_t tick);
  // Drops what does not lie still and was last heard before this tick.
  void Forget(std::uint32_t tick);

  [[nodiscard]] std::optional<protocol::Pose> Find(std::uint32_t body) const;
  // tickSeconds: world seconds a tick; newestTick: the newest known of any body.
  [[nodiscard]] std::optional<Sighting> FindSighting(std::uint32_t body, double tickSeconds,
                                                     std::uint32_t newestTick) const;
  // All bodies in no order; `sightings` is reused.
  void List(double tickSeconds, std::uint32_t newestTick, std::vector<Sighting>& sightings) const;

 private:
  struct Entry {
    protocol::QuantisedPose pose;
    protocol::QuantisedPose before;
    bool rests = false;            // at pose, and until something newer comes
    std::uint32_t tick = 0;        // of pose; 0: none yet
    std::uint32_t beforeTick = 0;  // of before; 0: none yet
    std::uint32_t removed = 0;     // tick of the last removal
    std::uint32_t respawned = 0;   // and of the last respawn

    [[nodiscard]] bool IsThere() const { return tick > removed; }
  };

  Entry* FindOrMake(std::uint32_t body);
  static Sighting MakeSighting(std::uint32_t body, const Entry& entry, double tickSeconds, std::uint32_t newestTick);

  std::unordered_map<std::uint32_t, Entry> m_entries;
};

}  // namespace wobble::client
