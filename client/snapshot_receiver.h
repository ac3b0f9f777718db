// Receives snapshot packets: knows which have come, and keeps the bodies that their records show.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "client/blueprint_store.h"
#include "client/bodies.h"
#include "client/newest_poses.h"
#include "client/world_time.h"
#include "protocol/acknowledgement.h"
#include "protocol/codec/shape_codec.h"
#include "protocol/snapshot.h"

namespace wobble::client {

// Packets are untrusted: broken ones are dropped whole, and everything that is dropped is counted in the statistics.
class SnapshotReceiver {
 public:
  // The references must outlive the receiver. options: `curve` and `decode` are used.
  SnapshotReceiver(const Options& options, const BlueprintStore& blueprints, const WorldTime& time,
                   Statistics& statistics)
      : m_decodes(options.decode),
        m_blueprints(blueprints),
        m_time(time),
        m_statistics(statistics),
        m_curve(options.curve),
        m_bodies(options.curve) {}

  // Verifies a packet and counts it. Its head; nullopt when it is broken or has come before.
  [[nodiscard]] std::optional<protocol::SnapshotHead> Open(std::span<const std::uint8_t> packet);

  using OnDecoded = std::function<void(const DecodedPatch&)>;
  // Takes in the records of the packet that was opened last; its bytes must still be there. tick: of its head;
  // obstacles: of the welcome; onDecoded: called for each record that has been decoded, may be empty.
  void TakeRecords(std::uint32_t tick, std::span<const wire::Obstacle> obstacles, const OnDecoded& onDecoded);

  // Another scene follows: drops its bodies. Packets are counted on.
  void ForgetScene();

  // An event says that from this tick on the body is gone, or somewhere else.
  void Remove(std::uint32_t body, std::uint32_t tick);
  void NoteRespawn(std::uint32_t body, std::uint32_t tick) { m_newestPoses.NoteRespawn(body, tick); }
  // Drops moving bodies of which nothing has come for kForgetAfter of world time; at most once a second.
  void Forget(double now);

  // All bodies at the moment that is shown.
  void Sample(Detail detail, std::vector<BodySample>& samples);
  // See Bodies::FindTrack, at the moment that is shown.
  [[nodiscard]] const Track* FindTrack(std::uint32_t body) const { return m_bodies.FindTrack(body, m_time.Playback()); }
  [[nodiscard]] const NewestPoses& Poses() const { return m_newestPoses; }
  // For the acknowledgement.
  [[nodiscard]] const protocol::ReceivedWindow& Received() const { return m_received; }

 private:
  void TakeRecord(const protocol::Record& record, std::uint32_t tick, std::span<const wire::Obstacle> obstacles,
                  const OnDecoded& onDecoded);
  [[nodiscard]] bool DecodeRecord(const protocol::Record& record, const std::shared_ptr<const Blueprint>& blueprint,
                                  std::uint32_t tick, std::span<const wire::Obstacle> obstacles,
                                  const OnDecoded& onDecoded, protocol::QuantisedPose& pose);

  bool m_decodes;
  const BlueprintStore& m_blueprints;
  const WorldTime& m_time;
  Statistics& m_statistics;
  protocol::ReceivedWindow m_received;
  Curve m_curve;
  Bodies m_bodies;
  NewestPoses m_newestPoses;
  double m_nextForget = 0;
  std::vector<protocol::Record> m_records;  // of the packet opened last
  protocol::ShapeDecoder m_decoder;
  std::vector<protocol::Vector3> m_shape;  // scratch
};

}  // namespace wobble::client
