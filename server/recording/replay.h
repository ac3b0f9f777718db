// Plays a recording again: the same entries at the same ticks in a playground of the same scene.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "server/recording/recording.h"

namespace wobble::recording {

// What of a recording's world differs from the one that is played, in the first tick that does.
struct Difference {
  std::uint32_t tick = 0;
  std::optional<physics::BodyId> body;  // the first whose hash differs within a second; nullopt: only samples differ
};

struct GroundSettings {
  // How the playground is played; the bits do not depend on it.
  int threads = 1;
  int widestPack = physics::WorldSettings{}.widestPack;
};

// A playground as the recording's began, but for a keyframe. Null, and what is wrong with its scene in `error`.
[[nodiscard]] std::unique_ptr<server::Playground> MakeGround(const Head& head, const GroundSettings& settings,
                                                             std::string& error);

class Replay {
 public:
  // recording: open. ground: of the recording's scene, tick duration and seed, not yet played. Both outlive the replay.
  Replay(Recording& recording, server::Playground& ground);

  // Plays the next tick. False, and nothing is played, at the end.
  bool Advance();
  // Goes to the state after so many ticks, from the recording's first to its last, by the nearest keyframe before it.
  // Returns what is wrong with the file; empty: nothing. It is called once before the first Advance.
  [[nodiscard]] std::string Seek(std::uint32_t tick);
  // The first part of Seek: goes to where it plays on from.
  [[nodiscard]] std::string Approach(std::uint32_t tick);
  // Goes to a state of this recording. Returns what is wrong with it; empty: nothing.
  [[nodiscard]] std::string Restore(const server::PlaygroundState& state);
  // The ground's tick.
  [[nodiscard]] std::uint32_t Tick() const { return m_ground.World().Tick(); }

  // What of the world differed from the recorded one, at the first tick since the last Seek that did.
  [[nodiscard]] const std::optional<Difference>& FirstDifference() const { return m_difference; }
  // Whether the whole state is now that of the keyframe, to the bit.
  [[nodiscard]] bool Matches(const BlockPlace& keyframe);

 private:
  // Makes the state that of the last keyframe up to this tick, unless the way from here is shorter.
  [[nodiscard]] std::string GoToKeyframe(std::uint32_t tick);
  // Makes m_second the one in which the next tick is played. False: there is none.
  bool FindSecond();
  void Compare();

  Recording& m_recording;
  server::Playground& m_ground;
  server::PlaygroundState m_fresh;  // of the scene as it begins
  bool m_isPlaced = false;          // a Seek has succeeded
  Second m_second;                  // that is being played
  std::size_t m_nextEntry = 0;      // of m_second
  std::optional<Difference> m_difference;
};

}  // namespace wobble::recording
