// Capturing and encoding every body before the choice was tried and rejected: of a thousand moving bodies most were
// shown to nobody, because a snapshot of sixteen clients holds a few dozen of them. So a body is encoded when the
// budget takes it, and ahead of that where it is likely to be taken: together with others that costs three fifths of
// what it costs alone, and threads share it.
#include "server/snapshots/snapshot_store.h"

namespace wobble::server {

SnapshotStore::SnapshotStore(const physics::World& world, int threads, std::vector<Bases> bases, PhaseWatch& watch)
    : m_world(world),
      m_watch(watch),
      m_blueprints(std::move(bases)),
      m_encoder(CaptureObstacles(world.Obstacles()), threads) {}

void SnapshotStore::EncodeAhead(BodySubset subset) {
  m_watch.Enter(Phase::kCapture);
  m_fresh.clear();
  const std::span<const ShownBody> bodies = m_captures.Bodies();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!subset.Has(bodies[i].body) || m_captures.Version(i) != 0 || !m_encoder.IsExpected(i)) continue;
    m_fresh.push_back({.index = i});
  }
  m_encoder.Workers().ForEach(m_fresh.size(), [this](std::size_t i) {
    FreshCapture& fresh = m_fresh[i];
    fresh.body = &m_captures.Read(m_world, fresh.index);
    fresh.blueprint = &m_blueprints[fresh.body->blueprint];
  });
  m_watch.Enter(Phase::kEncode);
  m_encoder.EncodeAhead(m_fresh);
}

const EncodedBody& SnapshotStore::Read(std::size_t index, std::size_t quality) {
  if (const EncodedBody* known = m_encoder.Find(index, quality, m_captures.Version(index))) return *known;
  const Phase outer = m_watch.Enter(Phase::kCapture);
  const CapturedBody& captured = m_captures.Read(m_world, index);
  m_watch.Enter(Phase::kEncode);
  const EncodedBody& encoded = m_encoder.Encode(index, quality, captured, m_blueprints[captured.blueprint]);
  m_watch.Enter(outer);
  return encoded;
}

}  // namespace wobble::server
