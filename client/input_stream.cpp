// Stamps must grow with every frame, or the server could not tell a new frame from a repetition. They must not run
// ahead, or the server would keep each frame until its tick has come, a delay that would never end. So a frame is
// stamped with the estimated tick or the tick after its predecessor's, whichever is later, and is left out when that is
// too far ahead. This happens when the world runs slower than the client sends, and after the clock was set back.
#include "client/input_stream.h"

#include <algorithm>
#include <cmath>

namespace wobble::client {
namespace {

// Ticks that a stamp may be ahead of the estimate: as much as sending and ticks can be out of step.
constexpr std::uint64_t kMaxStampLead = 1;
constexpr double kLastTick = 4294967295.0;

std::uint8_t ToButtons(const Input& input) {
  return static_cast<std::uint8_t>((input.jump ? 1 : 0) | (input.puff ? 2 : 0) | (input.stiffen ? 4 : 0));
}

}  // namespace

std::int8_t RoundAxis(float value) {
  if (std::isnan(value)) return 0;
  return static_cast<std::int8_t>(std::lround(std::clamp(value, -1.0F, 1.0F) * 127.0F));
}

void InputStream::Add(const Input& input, double estimatedTick, double now) {
  const auto estimated = static_cast<std::uint64_t>(std::clamp(std::floor(estimatedTick), 0.0, kLastTick));
  const std::uint64_t next = m_count == 0 ? 1 : std::uint64_t{m_frames[0].tick()} + 1;
  const std::uint64_t stamp = std::max(estimated, next);
  const bool ahead = stamp > estimated + kMaxStampLead || stamp > static_cast<std::uint64_t>(kLastTick);
  if (m_count > 0 && ahead) return;

  std::copy_backward(m_frames.begin(), m_frames.end() - 1, m_frames.end());
  const auto tick = static_cast<std::uint32_t>(stamp);
  m_frames[0] = wire::InputFrame(tick, RoundAxis(input.moveX), RoundAxis(input.moveY), ToButtons(input));
  m_count = std::min(m_count + 1, m_frames.size());
  m_sent[tick % kRemembered] = {tick, now};
}

double InputStream::MeasureEcho(std::uint32_t inputTick, double now) {
  const SentFrame& frame = m_sent[inputTick % kRemembered];
  if (inputTick <= m_echoed || frame.tick != inputTick) return -1;
  m_echoed = inputTick;
  return now - frame.sentAt;
}

}  // namespace wobble::client
