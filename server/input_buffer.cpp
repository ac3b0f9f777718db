#include "server/input_buffer.h"

#include <algorithm>
#include <cassert>

namespace wobble::server {

using protocol::wire::InputFrame;

namespace {

// For so many times holdTicks a gap is expected to come again: 10 s.
constexpr std::uint32_t kGapMemory = 100;

}  // namespace

void InputBuffer::Add(const InputFrame& frame, [[maybe_unused]] std::uint32_t currentTick) {
  assert(IsNear(frame, currentTick));
  // Old frames are kept however old they are: with a delay of a second each way, all frames arrive two seconds after
  // their ticks. A frame whose slot holds a newer one has been overtaken.
  InputFrame& slot = m_waiting[frame.tick() % m_waiting.size()];
  if (frame.tick() <= NewestUsed() || frame.tick() < slot.tick()) return;
  slot = frame;
  m_newestWaiting = std::max(m_newestWaiting, frame.tick());
}

InputFrame InputBuffer::Take(std::uint32_t tick, std::uint32_t holdTicks) {
  const std::uint32_t used = NewestUsed();
  const std::uint32_t window = static_cast<std::uint32_t>(m_waiting.size());
  const std::uint32_t last = std::min(tick, m_newestWaiting);
  const std::uint32_t first = std::max(used + 1, last >= window ? last - window + 1 : 1);
  std::uint8_t pressed = 0;
  for (std::uint32_t stamp = first; stamp <= last; ++stamp) {
    const InputFrame& frame = m_waiting[stamp % window];
    if (frame.tick() != stamp) continue;
    pressed |= frame.buttons();
    m_current = frame;
  }
  if (NewestUsed() != used) {
    if (used != 0) NoteGap(tick, holdTicks);
    m_usedAt = tick;
    return {NewestUsed(), m_current.move_x(), m_current.move_y(), pressed};
  }
  if (tick - m_usedAt <= std::max(holdTicks, m_gap)) return m_current;
  if (NewestUsed() != 0) ++m_starved;
  return {NewestUsed(), 0, 0, 0};
}

void InputBuffer::NoteGap(std::uint32_t tick, std::uint32_t holdTicks) {
  const auto most = static_cast<std::uint32_t>(kMostHolds * holdTicks);
  const std::uint32_t gap = std::min(tick - m_usedAt, most);
  const bool isForgotten = tick - m_gapAt > kGapMemory * holdTicks;
  if (gap < m_gap && !isForgotten) return;
  m_gap = gap;
  m_gapAt = tick;
}

}  // namespace wobble::server
