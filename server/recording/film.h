// A recording that is shown: played at any speed, forwards and backwards, stepped and gone to.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <string>

#include "server/recording/keyframe_index.h"
#include "server/recording/replay.h"

namespace wobble::recording {

inline constexpr double kLeastFilmSpeed = -4;
inline constexpr double kMostFilmSpeed = 16;

class Film {
 public:
  // kPlaying: -> kPaused on order, and at either end. kPaused: -> kPlaying on order.
  enum class Motion { kPlaying, kPaused };

  // path: of `recording`, which is open; nothing is played before Begin.
  Film(std::filesystem::path path, Recording recording);

  // Binds it to the playground that it is played in, of the recording's scene, tick duration and seed, and goes to the
  // first tick. Returns what is wrong with the file; empty: nothing.
  [[nodiscard]] std::string Begin(server::Playground& ground);

  // Plays what falls into a tick of the show. Returns whether the playground has changed.
  bool Advance();

  void Play();
  void Pause() { m_motion = Motion::kPaused; }
  // World seconds a second, from kLeastFilmSpeed to kMostFilmSpeed; below 0 backwards.
  void SetSpeed(double speed) { m_speed = speed; }
  // Pauses so many ticks further on; backwards below 0.
  void StepBy(std::int64_t ticks);
  // To so many s since the beginning, or to the end that is nearer.
  void JumpTo(double time);

  [[nodiscard]] Motion ReadMotion() const { return m_motion; }
  [[nodiscard]] double Speed() const { return m_speed; }
  [[nodiscard]] double Time() const { return m_recording.TimeOf(m_replay->Tick()); }       // s
  [[nodiscard]] double End() const { return m_recording.TimeOf(m_recording.LastTick()); }  // s
  [[nodiscard]] const Recording& ReadRecording() const { return m_recording; }
  [[nodiscard]] const KeyframeIndex& Index() const { return m_index; }
  // Why it stopped before its end; empty: it did not.
  [[nodiscard]] const std::string& Fault() const { return m_fault; }

 private:
  // Goes to a tick of the recording: over the states of before, by the index, or by the recording's own keyframes.
  void GoTo(std::uint32_t tick);
  void FillWindow(std::uint32_t from, std::uint32_t to);
  [[nodiscard]] std::uint32_t Clamp(double tick) const;

  Recording m_recording;
  KeyframeIndex m_index;
  server::Playground* m_ground = nullptr;
  std::unique_ptr<Replay> m_replay;
  Motion m_motion = Motion::kPlaying;
  double m_speed = 1;
  double m_owed = 0;  // ticks
  bool m_hasJumped = false;
  std::string m_fault;
  // The states of the ticks from m_windowBegin on, through which it goes backwards.
  std::deque<server::PlaygroundState> m_window;
  std::uint32_t m_windowBegin = 0;
};

}  // namespace wobble::recording
