// Going backwards, a world can only be gone back to: from the keyframe before it is played on to the tick that is
// wanted, and the states on the way are kept for the ticks that are wanted next.
#include "server/recording/film.h"

#include <algorithm>
#include <cmath>

namespace wobble::recording {
namespace {

// Of a tick of the show; the rest is for who watches it.
constexpr double kTimeShare = 0.75;

}  // namespace

Film::Film(std::filesystem::path path, Recording recording, server::TimeSource clock)
    : m_recording(std::move(recording)), m_index(std::move(path)), m_clock(std::move(clock)) {}

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
  m_timeLeft = kTimeShare / m_recording.ReadHead().tickHz;
  if (m_seek) {
    SeekOn();
  } else if (m_motion == Motion::kPlaying) {
    PlayOn();
  }
  return !IsGathering() && std::exchange(m_hasMoved, false);
}

void Film::PlayOn() {
  m_owed += m_speed;
  const double whole = std::trunc(m_owed);
  m_owed -= whole;
  if (whole == 0) return;
  const std::uint32_t before = Tick();
  const std::uint32_t wanted = Clamp(before + whole);
  if (wanted > before) {
    const double end = Now() + m_timeLeft;
    while (Tick() < wanted && m_replay->Advance() && Now() <= end) {
    }
    m_hasMoved = true;
  } else {
    GoTo(wanted);
  }
  const bool isAtEnd = GoalTick() == (m_speed > 0 ? m_recording.LastTick() : m_recording.FirstTick());
  if (isAtEnd || GoalTick() == before) m_motion = Motion::kPaused;
}

void Film::Play() {
  m_motion = Motion::kPlaying;
  const bool isAtEnd = m_speed > 0 && GoalTick() == m_recording.LastTick();
  if (isAtEnd) JumpTo(0);
}

void Film::StepBy(std::int64_t ticks) {
  m_motion = Motion::kPaused;
  GoTo(Clamp(double{1} * GoalTick() + static_cast<double>(ticks)));
}

void Film::JumpTo(double time) {
  GoTo(Clamp(m_recording.FirstTick() + std::round(time * m_recording.ReadHead().tickHz)));
}

void Film::GoTo(std::uint32_t tick) {
  const bool isBeingGathered = IsGathering() && tick >= m_windowBegin && tick <= m_seek->last;
  if (isBeingGathered) {
    m_seek->target = tick;
  } else if (tick == Tick()) {
    m_seek.reset();
  } else {
    m_seek = Seek{.target = tick};
  }
  SeekOn();
}

void Film::SeekOn() {
  const double begin = Now();
  const double end = begin + m_timeLeft;
  while (m_seek && (!m_clock || Now() < end)) {
    if (m_seek->isPlaced) {
      PlaySeek();
    } else {
      Place();
    }
    m_hasMoved = true;
  }
  m_timeLeft -= Now() - begin;
}

void Film::EndSeek(std::string fault) {
  m_seek.reset();
  if (!fault.empty()) m_fault = std::move(fault);
}

const server::PlaygroundState* Film::FindInWindow(std::uint32_t tick) const {
  const bool isIn = tick >= m_windowBegin && tick < m_windowBegin + m_window.size();
  return isIn ? &m_window[tick - m_windowBegin] : nullptr;
}

std::string Film::Approach(std::uint32_t tick, const std::optional<KeyframeIndex::Keyframe>& keyframe) {
  std::optional<server::PlaygroundState> state;
  if (keyframe) state = FromBytes<server::PlaygroundState>(keyframe->bytes);
  std::string error;
  if (state) error = m_replay->Restore(*state);
  return error.empty() ? m_replay->Approach(tick) : error;
}

void Film::Place() {
  const std::uint32_t target = m_seek->target;
  const std::uint32_t present = Tick();
  const std::uint32_t every = kIndexSeconds * m_recording.ReadHead().tickHz;
  const bool isNear = target < present && present - target <= every;
  if (const server::PlaygroundState* known = isNear ? FindInWindow(target) : nullptr) {
    return EndSeek(m_replay->Restore(*known));
  }
  m_window.clear();
  std::string error;
  if (isNear) {
    // As a keyframe of the index has it; where that is not made yet, from so long before as a window is.
    const std::uint32_t first = m_recording.FirstTick();
    m_windowBegin = first + (target - first) / every * every;
    m_seek->last = std::min(present, m_windowBegin + every - 1);
    m_seek->gathers = true;
    error = Approach(m_windowBegin, m_index.Find(m_windowBegin));
  } else {
    // Onwards the way from here may be the shorter one.
    auto keyframe = m_index.Find(target);
    if (keyframe && target > present && keyframe->tick <= present) keyframe.reset();
    error = Approach(target, keyframe);
  }
  m_seek->isPlaced = true;
  if (!error.empty()) EndSeek(std::move(error));
}

void Film::PlaySeek() {
  const bool isInWindow = m_seek->gathers && Tick() >= m_windowBegin;
  if (isInWindow) m_window.push_back(m_ground->Capture());
  if (Tick() < (m_seek->gathers ? m_seek->last : m_seek->target) && m_replay->Advance()) return;
  const server::PlaygroundState* found = m_seek->gathers ? FindInWindow(m_seek->target) : nullptr;
  EndSeek(found != nullptr ? m_replay->Restore(*found) : std::string());
}

}  // namespace wobble::recording
