#include "server/recording/recording.h"

#include <algorithm>

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

std::string Recording::Open(const std::filesystem::path& path) {
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
  return {};
}

std::string Recording::Take(const Block& block) {
  if (block.kind == BlockKind::kHead || block.kind == BlockKind::kCheckpoint) {
    return At(block, std::string("a ") + Name(block.kind) + " in the middle of a recording");
  }
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
  (block.kind == BlockKind::kKeyframe ? m_keyframes : m_seconds).push_back({block.offset, tick});
  return {};
}

Bytes Recording::ReadKeyframe(const BlockPlace& place) {
  m_file.Seek(place.offset);
  std::optional<Block> block = m_file.Next();
  return block ? std::move(block->bytes) : Bytes();
}

std::optional<Second> Recording::ReadSecond(std::uint32_t tick) {
  const auto behind = std::ranges::upper_bound(m_seconds, tick, {}, &BlockPlace::tick);
  if (behind == m_seconds.begin()) return {};
  m_file.Seek(std::prev(behind)->offset);
  const std::optional<Block> block = m_file.Next();
  auto second = block ? FromBytes<Second>(block->bytes) : std::nullopt;
  if (second && tick - second->begin >= second->traces.size()) second.reset();
  return second;
}

}  // namespace wobble::recording
