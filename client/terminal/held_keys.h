// Which of the player's keys are down, on a terminal that mostly does not say.
//
// Terminals send a key when it is pressed and again while it repeats (after some 0.25 to 0.66 s, then about 30 times a
// second), but nothing when it is let go. So a key counts as down
//   - for kFirstHold from its first press: long enough for the repeating to begin, so that a held key is held without a
//     gap, short enough for a tap to be a step;
//   - for kRepeatHold from each repetition: let go, it ends soon;
//   - until the opposite key or "stop" is pressed, if that is sooner.
// A keyboard repeats only the key pressed last. So when another key is pressed, those that are down stay down for
// kFirstHold more: one jumps while walking, and walks diagonally, without a halt.
//
// A terminal that reports releases (keys.h) says all of it itself, and then none of this is guessed.
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
  // Pressed for the first time or repeating: on most terminals that is the same.
  void Press(Action action, double now);
  void Release(Action action);
  void ReleaseAll();
  // From now on keys are down until Release.
  void TrustReleases() { m_releasesReported = true; }

  [[nodiscard]] bool IsHeld(Action action, double now) const;

 private:
  [[nodiscard]] double& Until(Action action) { return m_until[static_cast<std::size_t>(action)]; }

  std::array<double, kActionCount> m_until{};  // held before this moment, s
  bool m_releasesReported = false;
};

}  // namespace wobble::terminal
