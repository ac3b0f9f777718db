// A recording that is shown: played at any speed, forwards and backwards, stepped and gone to.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "server/recording/keyframe_index.h"
#include "server/recording/replay.h"
#include "server/timing/phases.h"

namespace wobble::recording {

inline constexpr double kLeastFilmSpeed = -4;
inline constexpr double kMostFilmSpeed = 16;

// Whoever calls Advance has little time: from far away, a tick is come to over several calls.
class Film {
 public:
  // kPlaying: -> kPaused on order, and at either end. kPaused: -> kPlaying on order.
  enum class Motion { kPlaying, kPaused };

  // path: of `recording`, which is open; nothing is played before Begin. clock: without it nothing takes time, and each
  // order is carried out at once.
  Film(std::filesystem::path path, Recording recording, server::TimeSource clock = {});

  // Binds it to the playground that it is played in, of the recording's scene, tick duration and seed, and goes to the
  // first tick. Returns what is wrong with the file; empty: nothing.
  [[nodiscard]] std::string Begin(server::Playground& ground);

  // Plays what falls into a tick of the show, or goes on to where an order wants it; takes three quarters of the tick's
  // time, or one tick of the recording. Returns whether the playground has changed.
  bool Advance();

  // Orders. They use what Advance has left of its time; a later one takes the place of one on the way.
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
  [[nodiscard]] std::uint32_t Tick() const { return m_replay->Tick(); }
  [[nodiscard]] double Time() const { return m_recording.TimeOf(Tick()); }                 // s
  [[nodiscard]] double End() const { return m_recording.TimeOf(m_recording.LastTick()); }  // s
  // Whether it is on the way, and to where; it plays on from there. Without a way: where it stands, s.
  [[nodiscard]] bool IsSeeking() const { return m_seek.has_value(); }
  [[nodiscard]] double Goal() const { return m_recording.TimeOf(GoalTick()); }
  // Whether the playground shows states that are gathered to go backwards through, and nothing for people.
  [[nodiscard]] bool IsGathering() const { return m_seek && m_seek->gathers; }
  [[nodiscard]] const Recording& ReadRecording() const { return m_recording; }
  [[nodiscard]] const KeyframeIndex& Index() const { return m_index; }
  // Why it stopped before its end since the last call; empty: it did not.
  [[nodiscard]] std::string TakeFault() { return std::exchange(m_fault, {}); }

 private:
  // The way to a tick: from the nearest state that is known before it, it is played.
  struct Seek {
    std::uint32_t target = 0;
    bool isPlaced = false;  // the state has been gone to
    bool gathers = false;   // the states from m_windowBegin to `last`, of which one is the target's
    std::uint32_t last = 0;
  };

  [[nodiscard]] std::uint32_t GoalTick() const { return m_seek ? m_seek->target : Tick(); }
  // Goes to a tick of the recording: over the states of before, by the index, or by the recording's own keyframes.
  void GoTo(std::uint32_t tick);
  void PlayOn();
  void SeekOn();
  // These two do the least part of the way. They end it by resetting m_seek.
  void Place();
  void PlaySeek();
  void EndSeek(std::string fault);
  // Goes to the last state that is known up to this tick: the keyframe's, or one of the recording. Returns what is
  // wrong; empty: nothing.
  [[nodiscard]] std::string Approach(std::uint32_t tick, const std::optional<KeyframeIndex::Keyframe>& keyframe);
  [[nodiscard]] const server::PlaygroundState* FindInWindow(std::uint32_t tick) const;
  [[nodiscard]] std::uint32_t Clamp(double tick) const;
  [[nodiscard]] double Now() const { return m_clock ? m_clock() : 0; }

  Recording m_recording;
  KeyframeIndex m_index;
  server::TimeSource m_clock;
  server::Playground* m_ground = nullptr;
  std::unique_ptr<Replay> m_replay;
  Motion m_motion = Motion::kPlaying;
  double m_speed = 1;
  double m_owed = 0;      // ticks
  double m_timeLeft = 0;  // of Advance's, s
  bool m_hasMoved = false;
  std::optional<Seek> m_seek;
  std::string m_fault;
  // The states of the ticks from m_windowBegin on, through which it goes backwards.
  std::deque<server::PlaygroundState> m_window;
  std::uint32_t m_windowBegin = 0;
};

}  // namespace wobble::recording
