#include "client/snapshot_receiver.h"

#include <algorithm>
#include <bit>

namespace wobble::client {
namespace {

constexpr double kForgetEvery = 1.0;  // seconds

}  // namespace

std::optional<protocol::SnapshotHead> SnapshotReceiver::Open(std::span<const std::uint8_t> packet) {
  protocol::SnapshotHead head;
  if (protocol::ReadSnapshot(packet, head, m_records) != protocol::SnapshotResult::kOk) {
    ++m_statistics.badSnapshots;
    return std::nullopt;
  }
  if (m_received.Record(head.sequence) != protocol::ReceivedWindow::Arrival::kNew) {
    ++m_statistics.duplicates;
    return std::nullopt;
  }
  ++m_statistics.snapshots;
  m_statistics.records += m_records.size();
  const unsigned known = std::min(m_received.Newest() - 1, protocol::kAckHistory);
  const auto arrived = static_cast<unsigned>(std::popcount(m_received.History()));
  m_statistics.lossShare = known == 0 ? 0.0 : std::max(0.0, 1.0 - static_cast<double>(arrived) / known);
  return head;
}

void SnapshotReceiver::TakeRecords(std::uint32_t tick, std::span<const wire::Obstacle> obstacles,
                                   const OnDecoded& onDecoded) {
  for (const protocol::Record& record : m_records) TakeRecord(record, tick, obstacles, onDecoded);
}

void SnapshotReceiver::TakeRecord(const protocol::Record& record, std::uint32_t tick,
                                  std::span<const wire::Obstacle> obstacles, const OnDecoded& onDecoded) {
  const std::shared_ptr<const Blueprint> blueprint = m_blueprints.Find(record.head.blueprint, record.head.generation);
  if (blueprint == nullptr) {
    ++m_statistics.unknownRecords;
    return;
  }
  protocol::QuantisedPose pose;
  const bool isGood =
      record.head.patch < blueprint->patches.size() &&
      (m_decodes ? DecodeRecord(record, blueprint, tick, obstacles, onDecoded, pose)
                 : protocol::DecodePose(record.payload, blueprint->size, pose) == protocol::DecodeResult::kOk);
  if (!isGood) {
    ++m_statistics.badRecords;
  } else if (record.head.patch == 0) {
    m_newestPoses.Add(record.head, tick, pose);
  }
}

bool SnapshotReceiver::DecodeRecord(const protocol::Record& record, const std::shared_ptr<const Blueprint>& blueprint,
                                    std::uint32_t tick, std::span<const wire::Obstacle> obstacles,
                                    const OnDecoded& onDecoded, protocol::QuantisedPose& pose) {
  const protocol::RecordHead& head = record.head;
  const protocol::PatchModel model =
      protocol::MakePatchModel(blueprint->rest, blueprint->size, blueprint->patches, head.patch, obstacles);
  m_shape.resize(model.rest.size());
  if (m_decoder.Decode(model, record.payload, pose, m_shape) != protocol::DecodeResult::kOk) return false;
  const protocol::Pose seen = protocol::Dequantise(pose);
  if (onDecoded) onDecoded({.body = head.body, .tick = tick, .pose = seen, .shape = m_shape});
  const double time = m_time.TimeOf(head.restTick != 0 ? head.restTick : tick);
  return m_bodies.Add(head, blueprint, tick, time, seen, m_shape, m_time.Playback());
}

void SnapshotReceiver::ForgetScene() {
  m_bodies = Bodies(m_curve);
  m_newestPoses = {};
}

void SnapshotReceiver::Remove(std::uint32_t body, std::uint32_t tick) {
  m_bodies.Remove(body, tick);
  m_newestPoses.Remove(body, tick);
}

void SnapshotReceiver::Forget(double now) {
  if (now < m_nextForget) return;
  m_nextForget = now + kForgetEvery;
  m_bodies.Forget(m_time.TimeOf(m_time.NewestTick()) - kForgetAfter);
  const auto kept = static_cast<std::uint32_t>(kForgetAfter * m_time.TickHz());
  if (m_time.NewestTick() > kept) m_newestPoses.Forget(m_time.NewestTick() - kept);
}

void SnapshotReceiver::Sample(Detail detail, std::vector<BodySample>& samples) {
  m_bodies.Sample(m_time.Playback(), m_time.TimeOf(m_time.NewestTick()), detail, samples, m_statistics);
}

}  // namespace wobble::client
