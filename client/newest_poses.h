// The newest received pose of every body. Poses are read without decoding vertices, so a load test can afford it for
// hundreds of clients.
#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "client/client.h"
#include "protocol/codec/pose.h"
#include "protocol/snapshot.h"

namespace wobble::client {

// Poses further apart than this, seconds of world time, give no velocity.
inline constexpr double kMaxVelocitySpan = 0.5;

class NewestPoses {
 public:
  // The blueprint of a body's newest record.
  struct Form {
    std::uint8_t blueprint = 0;
    std::uint8_t generation = 0;
  };

  // A record of the body's first patch. Ignored when it is not newer than the newest known or than a removal, and when
  // there are protocol::kMaxBodies others.
  void Add(const protocol::RecordHead& head, std::uint32_t tick, const protocol::QuantisedPose& pose);
  // Events of the server: from this tick on the body is gone, or somewhere else.
  void Remove(std::uint32_t body, std::uint32_t tick);
  void NoteRespawn(std::uint32_t body, std::uint32_t tick);
  // Drops bodies that are not at rest and whose last record or event is older than this tick.
  void Forget(std::uint32_t tick);

  [[nodiscard]] std::optional<protocol::Pose> Find(std::uint32_t body) const;
  [[nodiscard]] std::optional<Form> FindForm(std::uint32_t body) const;
  // tickSeconds: world seconds per tick; newestTick: the newest known of any body.
  [[nodiscard]] std::optional<Sighting> FindSighting(std::uint32_t body, double tickSeconds,
                                                     std::uint32_t newestTick) const;
  // All bodies in no order; `sightings` is overwritten.
  void List(double tickSeconds, std::uint32_t newestTick, std::vector<Sighting>& sightings) const;

 private:
  struct Entry {
    protocol::QuantisedPose pose;
    protocol::QuantisedPose before;
    Form form;
    bool rests = false;            // at pose, until a newer record comes
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
