// Which of the player's keys are down, on a terminal that mostly does not report releases.
//
// Terminals send a key when it is pressed and again while it repeats (after some 0.25 to 0.66 s, then about 30 times a
// second), but nothing on release. A key therefore counts as down
// - for kFirstHold from its first press: long enough for the repetition to begin, so that a held key has no gap, short
//   enough for a tap to be a step;
// - for kRepeatHold from each repetition, so that it ends soon after the release;
// - until the opposite key or "stop" is pressed, if that is sooner.
// A keyboard repeats only the key pressed last. When another key is pressed, the keys that are down therefore stay down
// for kFirstHold more: a player can jump while walking, and walk diagonally, without a halt.
//
// A terminal that reports releases (keys.h) gives exact times, and none of this applies.
#pragma once

#include <array>
#include <cstddef>

namespace wobble::terminal {

enum class Action { kForward, kBack, kLeft, kRight, kJump, kPuff, kStiffen };
inline constexpr std::size_t kActionCount = 7;

inline constexpr double kFirstHold = 0.5;    // s
inline constexpr double kRepeatHold = 0.15;  // s

class HeldKeys {
 public:
  // A first press or a repetition; most terminals do not tell them apart.
  void Press(Action action, double now);
  void Release(Action action);
  void ReleaseAll();
  // From now on a key is down until Release.
  void TrustReleases() { m_releasesReported = true; }

  [[nodiscard]] bool IsHeld(Action action, double now) const;

 private:
  [[nodiscard]] double& Until(Action action) { return m_until[static_cast<std::size_t>(action)]; }

  std::array<double, kActionCount> m_until{};  // the key counts as down before this time, s
  bool m_releasesReported = false;
};

}  // namespace wobble::terminal
