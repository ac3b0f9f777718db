#include "server/recording/replay.h"

#include <algorithm>

#include "server/scenes/loader.h"

namespace wobble::recording {
namespace {

constexpr std::uint32_t kLeastTickHz = 10;  // as wobbled's --tick-hz
constexpr std::uint32_t kMostTickHz = 480;

// The tick of a keyframe stands first in it.
std::uint32_t ReadTick(const Bytes& keyframe) {
  std::uint32_t tick = 0;
  Reader reader(keyframe);
  reader(tick);
  return tick;
}

std::string At(const Block& block, const std::string& what) {
  return "byte " + std::to_string(block.offset) + ": " + what;
}

}  // namespace

std::unique_ptr<Replay> Replay::Open(const std::filesystem::path& path, const ReplaySettings& settings,
                                     std::string& error) {
  std::unique_ptr<Replay> replay(new Replay(settings));
  error = replay->ReadAll(path);
  if (error.empty()) error = replay->Seek(replay->m_firstTick);
  if (!error.empty()) replay.reset();
  return replay;
}

std::string Replay::ReadAll(const std::filesystem::path& path) {
  std::string error = m_file.Open(path);
  if (!error.empty()) return error;
  const std::optional<Block> first = m_file.Next();
  std::optional<Head> head;
  if (first && first->kind == BlockKind::kHead) head = FromBytes<Head>(first->bytes);
  if (!head) return "has no head that can be read" + (m_file.Fault().empty() ? "" : " (" + m_file.Fault() + ")");
  m_head = std::move(*head);
  if (m_head.tickHz < kLeastTickHz || m_head.tickHz > kMostTickHz) {
    return "is of " + std::to_string(m_head.tickHz) + " ticks a second; must be 10 to 480";
  }
  while (const std::optional<Block> block = m_file.Next()) {
    m_fault = Take(*block);
    if (!m_fault.empty()) break;
  }
  if (m_fault.empty()) m_fault = m_file.Fault();
  if (!m_fault.empty()) m_isWhole = false;
  if (!m_head.beginsFresh && m_keyframes.empty()) {
    return "has no keyframe to begin with" + (m_fault.empty() ? "" : " (" + m_fault + ")");
  }
  m_firstTick = m_head.beginsFresh ? 0 : m_keyframes.front().tick;
  m_lastTick = std::max(m_lastTick, m_firstTick);
  return MakeGround();
}

std::string Replay::Take(const Block& block) {
  if (block.kind == BlockKind::kHead) return At(block, "a second head");
  m_isWhole = block.kind == BlockKind::kEnd;
  if (block.kind == BlockKind::kEnd) return {};
  const bool isFirst = m_keyframes.empty() && m_seconds.empty();
  if (isFirst && m_head.beginsFresh == (block.kind == BlockKind::kKeyframe)) {
    return At(block, std::string("begins with a ") + Name(block.kind));
  }
  std::uint32_t tick = 0;
  std::uint32_t end = 0;
  if (block.kind == BlockKind::kKeyframe) {
    tick = end = ReadTick(block.bytes);
  } else {
    const auto second = FromBytes<Second>(block.bytes);
    if (!second) return At(block, "a second cannot be read");
    tick = second->begin;
    end = tick + static_cast<std::uint32_t>(second->traces.size());
  }
  if (!isFirst && tick != m_lastTick) {
    return At(block, std::string("a ") + Name(block.kind) + " of tick " + std::to_string(tick) + "; must be of tick " +
                         std::to_string(m_lastTick));
  }
  if (isFirst && m_head.beginsFresh && tick != 0) return At(block, "begins with tick " + std::to_string(tick));
  m_lastTick = end;
  (block.kind == BlockKind::kKeyframe ? m_keyframes : m_seconds).push_back({block.kind, block.offset, tick});
  return {};
}

std::string Replay::MakeGround() {
  scenes::LoadResult loaded = scenes::ParseScene(m_head.scene);
  if (!loaded.errors.empty()) return "is of a scene with mistakes: " + loaded.errors.front();
  m_ground = std::make_unique<server::Playground>(std::move(loaded.scene),
                                                  server::PlaygroundSettings{.tickDuration = 1.0 / m_head.tickHz,
                                                                             .seed = m_head.seed,
                                                                             .threads = m_settings.threads,
                                                                             .widestPack = m_settings.widestPack});
  return {};
}

std::optional<server::PlaygroundState> Replay::ReadKeyframe(std::uint64_t offset) {
  m_file.Seek(offset);
  const std::optional<Block> block = m_file.Next();
  return block ? FromBytes<server::PlaygroundState>(block->bytes) : std::nullopt;
}

bool Replay::Matches(const BlockPlace& keyframe) {
  m_file.Seek(keyframe.offset);
  const std::optional<Block> block = m_file.Next();
  return block && block->bytes == ToBytes(m_ground->Capture());
}

std::string Replay::Seek(std::uint32_t tick) {
  m_difference.reset();
  const auto behind = std::ranges::upper_bound(m_keyframes, tick, {}, &BlockPlace::tick);
  const std::uint32_t nearest = behind == m_keyframes.begin() ? 0 : std::prev(behind)->tick;
  const std::uint32_t present = m_ground->World().Tick();
  const bool isOnTheWay = present >= nearest && present <= tick && present > m_firstTick;
  if (!isOnTheWay) {
    std::string error;
    if (behind == m_keyframes.begin()) {
      error = MakeGround();
    } else if (const auto state = ReadKeyframe(std::prev(behind)->offset)) {
      error = m_ground->Restore(*state);
    } else {
      error = "cannot be read";
    }
    if (!error.empty()) return "keyframe of tick " + std::to_string(nearest) + ": " + error;
    if (!m_seconds.empty()) FindSecond(nearest);
  }
  while (m_ground->World().Tick() < tick && Advance()) {
  }
  return {};
}

bool Replay::FindSecond(std::uint32_t tick) {
  auto found = std::ranges::upper_bound(m_seconds, tick, {}, &BlockPlace::tick);
  if (found == m_seconds.begin()) return false;
  m_file.Seek(std::prev(found)->offset);
  const std::optional<Block> block = m_file.Next();
  auto second = block ? FromBytes<Second>(block->bytes) : std::nullopt;
  if (!second) return false;
  m_second = std::move(*second);
  const std::uint32_t after = tick - m_second.begin;
  const auto isPast = [after](const TimedEntry& each) { return each.after < after; };
  m_nextEntry = static_cast<std::size_t>(std::ranges::find_if_not(m_second.entries, isPast) - m_second.entries.begin());
  return after < m_second.traces.size();
}

bool Replay::Advance() {
  const std::uint32_t tick = m_ground->World().Tick();
  if (tick >= m_lastTick) return false;
  if (tick - m_second.begin >= m_second.traces.size() && !FindSecond(tick)) return false;
  for (; m_nextEntry < m_second.entries.size(); ++m_nextEntry) {
    const TimedEntry& next = m_second.entries[m_nextEntry];
    if (next.after > tick - m_second.begin) break;
    m_ground->Take(next.entry);
  }
  m_ground->Step();
  Compare();
  return true;
}

void Replay::Compare() {
  const physics::World& world = m_ground->World();
  const std::uint32_t tick = world.Tick();
  const Trace& recorded = m_second.traces[tick - 1 - m_second.begin];
  const Trace played = MakeTrace(world, m_head.tickHz);
  const bool isSame = played.fingerprint == recorded.fingerprint && played.hashes == recorded.hashes;
  if (isSame || (m_difference && m_difference->body)) return;
  if (!m_difference) {
    m_difference = Difference{.tick = tick, .second = double{1} * (tick - m_firstTick) / m_head.tickHz, .body = {}};
  }
  const std::vector<physics::BodyId> bodies = ListHashed(world, m_head.tickHz);
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (i < recorded.hashes.size() && played.hashes[i] == recorded.hashes[i]) continue;
    if (tick <= m_difference->tick + m_head.tickHz) m_difference->body = bodies[i];
    return;
  }
}

}  // namespace wobble::recording
