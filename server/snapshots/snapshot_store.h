// The one owner of what is captured of the world and of the records encoded from it. The server tells it what has
// happened, SnapshotBudget asks it for records; it calls neither.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "server/physics/world.h"
#include "server/play/workshop.h"
#include "server/snapshots/blueprint_captures.h"
#include "server/snapshots/body_captures.h"
#include "server/snapshots/encoder.h"
#include "server/timing/phases.h"

namespace wobble::server {

// The bodies whose snapshot is due: those whose id leaves `remainder` when divided by `divisor`. By default all.
struct BodySubset {
  std::uint32_t remainder = 0;
  std::uint32_t divisor = 1;

  [[nodiscard]] bool Has(std::uint32_t body) const { return body % divisor == remainder; }
};

class SnapshotStore {
 public:
  // world, watch: outlive the store. threads: that EncodeAhead may use, 1 or more. bases: of the scene's blueprints, in
  // their order, or none.
  SnapshotStore(const physics::World& world, int threads, std::vector<Bases> bases, PhaseWatch& watch);

  // Notes what a step has changed. Call it after every step of the world, and after it was restored. tick: as clients
  // are told it, never backwards.
  void FollowStep(std::uint32_t tick) { m_captures.Follow(m_world, m_tick = tick); }
  // Captures blueprints that have changed; see BlueprintCaptures::Follow.
  std::span<const std::uint8_t> FollowBlueprints(const Workshop* workshop) {
    return m_blueprints.Follow(m_world, workshop);
  }
  // Makes Bodies() those whose records may be read after this tick. Blueprints have been followed.
  void BeginSnapshot() { m_encoder.Follow(m_captures.Bodies(), m_tick); }

  // Captures and encodes the bodies of the subset that are likely to be asked for, many together and on all threads. It
  // changes no record. Time goes to kCapture and kEncode.
  void EncodeAhead(BodySubset subset);

  // As of the last FollowStep, by ascending id.
  [[nodiscard]] std::span<const ShownBody> Bodies() const { return m_captures.Bodies(); }
  // The records of Bodies()[index] at one of kSnapshotErrorShares; captures and encodes them unless that has been done.
  // Valid until the body is encoded again. Time goes to kCapture and kEncode, then to the phase before.
  const EncodedBody& Read(std::size_t index, std::size_t quality);

  [[nodiscard]] const BlueprintCaptures& Blueprints() const { return m_blueprints; }
  [[nodiscard]] const Encoder& ReadEncoder() const { return m_encoder; }

 private:
  const physics::World& m_world;
  PhaseWatch& m_watch;
  BlueprintCaptures m_blueprints;
  BodyCaptures m_captures;
  Encoder m_encoder;
  std::uint32_t m_tick = 0;           // of the last FollowStep
  std::vector<FreshCapture> m_fresh;  // scratch of EncodeAhead
};

}  // namespace wobble::server
