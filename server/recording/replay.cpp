#include "server/recording/replay.h"

#include <algorithm>

#include "server/scenes/loader.h"

namespace wobble::recording {

std::unique_ptr<server::Playground> MakeGround(const Head& head, const GroundSettings& settings, std::string& error) {
  scenes::LoadResult loaded = scenes::ParseScene(head.scene);
  if (!loaded.errors.empty()) {
    error = "is of a scene with mistakes: " + loaded.errors.front();
    return nullptr;
  }
  return std::make_unique<server::Playground>(std::move(loaded.scene),
                                              server::PlaygroundSettings{.tickDuration = 1.0 / head.tickHz,
                                                                         .seed = head.seed,
                                                                         .threads = settings.threads,
                                                                         .widestPack = settings.widestPack});
}

Replay::Replay(Recording& recording, server::Playground& ground)
    : m_recording(recording), m_ground(ground), m_fresh(ground.Capture()) {}

bool Replay::Matches(const BlockPlace& keyframe) {
  return m_recording.ReadKeyframe(keyframe) == ToBytes(m_ground.Capture());
}

std::string Replay::Approach(std::uint32_t tick) {
  m_difference.reset();
  return GoToKeyframe(tick);
}

std::string Replay::Seek(std::uint32_t tick) {
  std::string error = Approach(tick);
  if (!error.empty()) return error;
  while (Tick() < tick && Advance()) {
  }
  return {};
}

std::string Replay::GoToKeyframe(std::uint32_t tick) {
  const std::vector<BlockPlace>& keyframes = m_recording.Keyframes();
  const auto behind = std::ranges::upper_bound(keyframes, tick, {}, &BlockPlace::tick);
  const bool isFresh = behind == keyframes.begin();
  const std::uint32_t nearest = isFresh ? 0 : std::prev(behind)->tick;
  if (m_isPlaced && Tick() >= nearest && Tick() <= tick) return {};
  std::optional<server::PlaygroundState> state;
  if (!isFresh) state = FromBytes<server::PlaygroundState>(m_recording.ReadKeyframe(*std::prev(behind)));
  std::string error = "cannot be read";
  if (isFresh || state) error = Restore(isFresh ? m_fresh : *state);
  return error.empty() ? error : "keyframe of tick " + std::to_string(nearest) + ": " + error;
}

std::string Replay::Restore(const server::PlaygroundState& state) {
  std::string error = m_ground.Restore(state);
  if (!error.empty()) return error;
  m_isPlaced = true;
  FindSecond();
  return {};
}

bool Replay::FindSecond() {
  std::optional<Second> second = m_recording.ReadSecond(Tick());
  m_second = second ? std::move(*second) : Second();
  const std::uint32_t after = Tick() - m_second.begin;
  const auto isPast = [after](const TimedEntry& each) { return each.after < after; };
  m_nextEntry = static_cast<std::size_t>(std::ranges::find_if_not(m_second.entries, isPast) - m_second.entries.begin());
  return second.has_value();
}

bool Replay::Advance() {
  const std::uint32_t tick = Tick();
  if (tick >= m_recording.LastTick()) return false;
  if (tick - m_second.begin >= m_second.traces.size() && !FindSecond()) return false;
  for (; m_nextEntry < m_second.entries.size(); ++m_nextEntry) {
    const TimedEntry& next = m_second.entries[m_nextEntry];
    if (next.after > tick - m_second.begin) break;
    m_ground.Take(next.entry);
  }
  m_ground.Step();
  Compare();
  return true;
}

void Replay::Compare() {
  const physics::World& world = m_ground.World();
  const std::uint32_t tickHz = m_recording.ReadHead().tickHz;
  const std::uint32_t tick = world.Tick();
  const Trace& recorded = m_second.traces[tick - 1 - m_second.begin];
  const Trace played = MakeTrace(world, tickHz);
  const bool isSame = played.fingerprint == recorded.fingerprint && played.hashes == recorded.hashes;
  if (isSame || (m_difference && m_difference->body)) return;
  if (!m_difference) {
    m_difference = Difference{.tick = tick, .body = {}};
  }
  const std::vector<physics::BodyId> bodies = ListHashed(world, tickHz);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (i < recorded.hashes.size() && played.hashes[i] == recorded.hashes[i]) continue;
    if (tick <= m_difference->tick + tickHz) m_difference->body = bodies[i];
    return;
  }
}

}  // namespace wobble::recording
