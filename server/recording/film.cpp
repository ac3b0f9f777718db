// Going backwards, a world can only be gone back to: from the keyframe before it is played on to the tick that is
// wanted, and the states on the way are kept for the ticks that are wanted next.
#include "server/recording/film.h"

#include <algorithm>
#include <cmath>

namespace wobble::recording {

Film::Film(std::filesystem::path path, Recording recording)
    : m_recording(std::move(recording)), m_index(std::move(path)) {}

std::string Film::Begin(server::Playground& ground) {
  m_ground = &ground;
  m_replay = std::make_unique<Replay>(m_recording, ground);
  return m_replay->Seek(m_recording.FirstTick());
}

std::uint32_t Film::Clamp(double tick) const {
  return static_cast<std::uint32_t>(
      std::clamp(tick, double{1} * m_recording.FirstTick(), double{1} * m_recording.LastTick()));
}

bool Film::Advance() {
  const bool hasJumped = std::exchange(m_hasJumped, false);
  if (m_motion == Motion::kPaused) return hasJumped;
  m_owed += m_speed;
  const double whole = std::trunc(m_owed);
  m_owed -= whole;
  if (whole == 0) return hasJumped;
  const std::uint32_t before = m_replay->Tick();
  const std::uint32_t wanted = Clamp(before + whole);
  if (wanted > before) {
    while (m_replay->Tick() < wanted && m_replay->Advance()) {
    }
  } else {
    GoTo(wanted);
  }
  const bool isAtEnd = wanted == (m_speed > 0 ? m_recording.LastTick() : m_recording.FirstTick());
  if (isAtEnd || m_replay->Tick() == before) m_motion = Motion::kPaused;
  return hasJumped || m_replay->Tick() != before;
}

void Film::Play() {
  m_motion = Motion::kPlaying;
  const bool isAtEnd = m_speed > 0 && m_replay->Tick() == m_recording.LastTick();
  if (isAtEnd) JumpTo(0);
}

void Film::StepBy(std::int64_t ticks) {
  m_motion = Motion::kPaused;
  GoTo(Clamp(double{1} * m_replay->Tick() + static_cast<double>(ticks)));
}

void Film::JumpTo(double time) {
  GoTo(Clamp(m_recording.FirstTick() + std::round(time * m_recording.ReadHead().tickHz)));
}

void Film::GoTo(std::uint32_t tick) {
  const std::uint32_t present = m_replay->Tick();
  if (tick == present) return;
  m_hasJumped = true;
  const std::uint32_t every = kIndexSeconds * m_recording.ReadHead().tickHz;
  const bool isNear = tick < present && present - tick <= every;
  if (isNear && (tick < m_windowBegin || tick >= m_windowBegin + m_window.size())) FillWindow(tick, present);
  if (isNear && tick >= m_windowBegin && tick < m_windowBegin + m_window.size()) {
    m_fault = m_replay->Restore(m_window[tick - m_windowBegin]);
    return;
  }
  const auto keyframe = m_index.Find(tick);
  const bool isShorter = keyframe && (tick < present || keyframe->tick > present);
  std::optional<server::PlaygroundState> state;
  if (isShorter) state = FromBytes<server::PlaygroundState>(keyframe->bytes);
  if (state) m_fault = m_replay->Restore(*state);
  if (m_fault.empty()) m_fault = m_replay->Seek(tick);
  m_window.clear();
}

// Plays from the keyframe before `to` and keeps the states; where the index is not made yet, from so long before `from`
// as a window is.
void Film::FillWindow(std::uint32_t from, std::uint32_t to) {
  const std::uint32_t every = kIndexSeconds * m_recording.ReadHead().tickHz;
  const std::uint32_t first = m_recording.FirstTick();
  const std::uint32_t begin = first + (from - first) / every * every;
  m_window.clear();
  const auto keyframe = m_index.Find(begin);
  std::optional<server::PlaygroundState> state;
  if (keyframe) state = FromBytes<server::PlaygroundState>(keyframe->bytes);
  if (state) m_fault = m_replay->Restore(*state);
  if (m_fault.empty()) m_fault = m_replay->Seek(begin);
  m_windowBegin = begin;
  const std::uint32_t last = std::min(to, begin + every - 1);
  while (m_fault.empty() && m_replay->Tick() <= last) {
    m_window.push_back(m_ground->Capture());
    if (m_replay->Tick() == last || !m_replay->Advance()) break;
  }
}

}  // namespace wobble::recording
